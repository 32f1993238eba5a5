"""The command line of `abv trained`."""

import argparse

from active_binocular_vision.command_lines.start import start
from lockstep.written.command_line import CommandLine, command
from lockstep.written.paths import written_path


def parser() -> argparse.ArgumentParser:
    """Return the command line of `abv trained`."""
    line = CommandLine(
        prog=command("trained"),
        description="List the trained eyes that come with the package, whose names stand for a run"
        f" directory, as in {command('examine')} gaze_m_c --cover. With RUN: make such a file of a"
        " run that has ended.",
    )
    line.add_argument("run", nargs="?", type=written_path, metavar="RUN", help="run directory")
    line.add_argument(
        "--out",
        type=written_path,
        metavar="FILE",
        help="file to write (default: that of the run's profile in the package)",
    )
    return line


def main() -> None:
    """Run the command line as this process."""
    start("trained", parser)


if __name__ == "__main__":
    main()
