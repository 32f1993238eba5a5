"""The command line of `abv docs`."""

import os
import sys
from pathlib import Path

from lockstep.exit_codes import EXIT_BAD_INPUT
from lockstep.written.command_line import CommandLine, command

SCRIPT = Path(__file__).parents[4] / "launch_scripts" / "docs.sh"


def main() -> None:
    """Become the script that builds the site and opens it; only a clone has the pages."""
    CommandLine(
        prog=command("docs"),
        description="Build the site of all pages, with its tutorials run, and open it in the"
        " browser. This needs a clone of the repository.",
    ).parse_args()
    if not SCRIPT.is_file():
        print(f"error: expected a clone with {SCRIPT}, which has the pages", file=sys.stderr)
        sys.exit(EXIT_BAD_INPUT)
    os.execv(SCRIPT, [str(SCRIPT)])
