"""The command line of `abv parameters`."""

import argparse

from active_binocular_vision.command_lines.start import start
from experiment_manager.nodes import NODES
from lockstep.written.command_line import CommandLine, command
from lockstep.written.nearest import unknown


def parser() -> argparse.ArgumentParser:
    """Return the command line of `abv parameters`."""
    line = CommandLine(
        prog=command("parameters"),
        description="Print the parameters of nodes and their defaults, as a ROS parameter file.",
    )
    line.add_argument(
        "nodes",
        nargs="*",
        type=_node,
        metavar="NODE",
        help=f"some of {', '.join(NODES)}; default all",
    )
    return line


def _node(text: str) -> str:
    if text not in NODES:
        raise argparse.ArgumentTypeError(unknown(text, NODES))
    return text


def main() -> None:
    """Run the command line as this process."""
    start("parameters", parser)


if __name__ == "__main__":
    main()
