"""The command line of `abv evaluate`."""

import argparse

from active_binocular_vision.command_lines.start import start
from lockstep.written.command_line import CommandLine, command
from lockstep.written.paths import written_path


def parser() -> argparse.ArgumentParser:
    """Return the command line of `abv evaluate`."""
    line = CommandLine(
        prog=command("evaluate"),
        description="Recompute the measures of a run from its bag; compare them with results.json."
        f" {command('examine')} tests its learners again.",
    )
    line.add_argument("run", type=written_path, metavar="RUN", help="run directory")
    return line


def main() -> None:
    """Run the command line as this process."""
    start("evaluate", parser)


if __name__ == "__main__":
    main()
