"""The command line of `abv sweep`."""

import argparse

from active_binocular_vision.command_lines.start import start
from lockstep.written.command_line import CommandLine, command
from lockstep.written.paths import written_path


def parser() -> argparse.ArgumentParser:
    """Return the command line of `abv sweep`."""
    line = CommandLine(
        prog=command("sweep"),
        description="Make many runs that differ in a few options, several at a time, each in one"
        " process on one core, or as a job array of Slurm. Started again, it continues the"
        " unfinished runs. Ctrl-C stops all runs, with checkpoints. See docs/how_to/sweep.md",
    )
    line.add_argument(
        "sweep",
        type=written_path,
        metavar="SWEEP",
        help="a YAML file with options and axes, or the directory of a sweep to continue",
    )
    line.add_argument(
        "--out",
        type=written_path,
        metavar="DIR",
        help="directory of the sweep (default: runs/ and the name of the file)",
    )
    line.add_argument(
        "--stimuli",
        type=written_path,
        metavar="DIR",
        help="images for all runs, as in abv run",
    )
    line.add_argument(
        "--jobs", type=int, metavar="N", help="runs at a time (default: one per core)"
    )
    line.add_argument("--status", action="store_true", help="print the progress of each run")
    line.add_argument("--slurm", action="store_true", help="submit a job array to Slurm")
    line.add_argument("--partition", metavar="P", help="partition of the job array")
    line.add_argument(
        "--time",
        metavar="T",
        help="time limit of a task; a task that reaches it is requeued and continues",
    )
    line.add_argument("--memory", metavar="M", help="memory of a task, for example 2G")
    line.add_argument("--tasks", type=int, metavar="N", help="largest number of tasks at a time")
    line.add_argument("--task", type=int, help=argparse.SUPPRESS)
    return line


def main() -> None:
    """Run the command line as this process."""
    start("sweep", parser)


if __name__ == "__main__":
    main()
