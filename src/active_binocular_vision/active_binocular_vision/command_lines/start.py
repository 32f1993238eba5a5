"""A command from its options to its exit code."""

import argparse
import os
import sys
from collections.abc import Callable
from typing import NoReturn

from lockstep.machine.lasting_output import ignore_broken_pipes
from lockstep.machine.start import imported


def start(command: str, parser: Callable[[], argparse.ArgumentParser]) -> NoReturn:
    """Run a module of `commands` as this process, and exit with its code.

    Its imports take seconds, which a help and a mistyped option need not wait for.
    """
    ignore_broken_pipes()
    parser().parse_args()
    # Figures are files. A notebook's kernel names a backend that matplotlib may not find here.
    os.environ["MPLBACKEND"] = "agg"
    sys.exit(imported(f"active_binocular_vision.commands.{command}").main())
