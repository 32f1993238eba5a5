"""A command from its options to its exit code."""

import argparse
import os
import sys
from collections.abc import Callable
from importlib import import_module
from typing import NoReturn

from lockstep.machine.lasting_output import ignore_broken_pipes


def start(command: str, parser: Callable[[], argparse.ArgumentParser]) -> NoReturn:
    """Run a module of `commands` as this process, and exit with its code.

    Its imports take seconds, which a help and a mistyped option need not wait for.
    """
    ignore_broken_pipes()
    parser().parse_args()
    # Figures are files. A notebook's kernel names a backend that matplotlib may not find here.
    os.environ["MPLBACKEND"] = "agg"
    sys.exit(import_module(f"active_binocular_vision.commands.{command}").main())
