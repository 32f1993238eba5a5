"""Command lines that help who mistypes."""

import argparse
from collections.abc import Sequence
from typing import Any

from lockstep.nearest import did_you_mean


class CommandLine(argparse.ArgumentParser):
    """A parser that takes options by their whole names, and tells the nearest to an unknown one."""

    def __init__(self, **named: Any) -> None:
        """Take what argparse.ArgumentParser takes, by name."""
        super().__init__(allow_abbrev=False, **named)

    def parse_args(  # type: ignore[override]
        self, args: Sequence[str] | None = None, namespace: None = None
    ) -> argparse.Namespace:
        """Return the options; exits with 2 and a usage line when they cannot be parsed."""
        parsed, unknown = self.parse_known_args(args, namespace)
        if unknown:
            options = self._option_string_actions
            wrong = next((word for word in unknown if word.startswith("-")), "").partition("=")[0]
            self.error(f"unrecognized arguments: {' '.join(unknown)}{did_you_mean(wrong, options)}")
        return parsed
