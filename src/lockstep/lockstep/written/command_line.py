"""Command lines that suggest the nearest option."""

import argparse
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NoReturn

from lockstep.exit_codes import EXIT_BAD_INPUT
from lockstep.written.nearest import did_you_mean

# The scripts of launch_scripts, which set up what `abv` needs, name the one that people start.
_ABV = os.environ.get("ABV_COMMAND") or "abv"


def command(name: str) -> str:
    """Return how people start a command of `abv`, such as "abv run"."""
    return f"{_ABV} {name}"


class WithLists(argparse.HelpFormatter):
    """Wraps a description, and leaves the lines of an epilog that lists something as they are."""

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        return text if "\n" in text else super()._fill_text(text, width, indent)


class CommandLine(argparse.ArgumentParser):
    """A parser that takes options by their whole names and suggests the nearest one."""

    def __init__(self, **named: Any) -> None:
        """Take what argparse.ArgumentParser takes, by name."""
        super().__init__(allow_abbrev=False, **named)

    def parse_args(  # type: ignore[override]
        self, args: Sequence[str] | None = None, namespace: None = None
    ) -> argparse.Namespace:
        """Return the options; exits with 2 and one line when they cannot be parsed."""
        parsed, unknown = self.parse_known_args(args, namespace)
        if unknown:
            options = self._option_string_actions
            wrong = next((word for word in unknown if word.startswith("-")), "").partition("=")[0]
            hint = did_you_mean(wrong, options) or "; --help lists all options"
            self.error(f"unrecognized arguments: {' '.join(unknown)}{hint}")
        try:
            Path.cwd()
        except FileNotFoundError:  # numba, for one, cannot be imported then
            self.error("expected a working directory that exists; the one of this shell is gone")
        return parsed

    def error(self, message: str) -> NoReturn:
        """Exit with 2 and one line, without the usage of all options."""
        self.exit(EXIT_BAD_INPUT, f"{self.prog}: error: {message}\n")
