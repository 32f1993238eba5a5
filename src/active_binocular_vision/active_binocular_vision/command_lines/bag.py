"""The command line of `abv bag`."""

import argparse

from active_binocular_vision.command_lines.start import start
from lockstep.written.command_line import CommandLine, command
from lockstep.written.paths import written_path


def parser() -> argparse.ArgumentParser:
    """Return the command line of `abv bag`."""
    line = CommandLine(
        prog=command("bag"),
        description="Print the run, its learning curve, and topics with counts, rates and gaps.",
    )
    line.add_argument(
        "bag", type=written_path, metavar="BAG", help="bag directory, run directory or .mcap file"
    )
    line.add_argument(
        "--configuration", action="store_true", help="also print config.yaml of the run"
    )
    line.add_argument(
        "--repair", action="store_true", help="complete a bag that was cut off or damaged"
    )
    line.add_argument(
        "--extract",
        type=written_path,
        metavar="DIR",
        help="write all images into DIR as PNG files",
    )
    line.add_argument(
        "--film",
        type=written_path,
        metavar="FILE",
        help="write a film of episodes before, during and after learning, .mp4 or .gif",
    )
    line.add_argument(
        "--rate",
        type=float,
        metavar="X",
        help="simulated seconds per second of film (default: 5 iterations a second)",
    )
    return line


def main() -> None:
    """Run the command line as this process."""
    start("bag", parser)


if __name__ == "__main__":
    main()
