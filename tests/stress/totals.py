"""What many slices of the torture have measured together, kept in a file."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from lockstep.durable_files import replace_file
from lockstep.errors import InputError

# Of these figures the largest of all slices counts; all others are sums.
_LARGEST = ("growth_mb", "longest_s", "peak_mb", "farthest_days")


@dataclass
class PartTotals:
    """n_slices: done so far; n_done: kills, inputs, cuts or jumps; figures: see `added`."""

    n_slices: int = 0
    n_done: int = 0
    figures: dict[str, Any] = field(default_factory=dict)
    problems: list[str] = field(default_factory=list)


class Totals:
    """Totals by the name of the part; each slice that is added is in the file at once."""

    def __init__(self, path: Path | None, seed: int) -> None:
        """path: of the file, which may be there from before; None keeps none.

        Raises InputError for a file that holds something else, or the totals of another seed.
        """
        self._path = path
        self._seed = seed
        self.parts: dict[str, PartTotals] = {}
        if path is None or not path.exists():
            return
        try:
            document = json.loads(path.read_text())
            found = document["seed"]
            self.parts = {name: PartTotals(**part) for name, part in document["parts"].items()}
        except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
            raise InputError(f"{path}: expected totals of torture.sh: {error!r}") from error
        if found != seed:
            raise InputError(f"{path}: expected totals of seed {seed}, got those of seed {found}")

    def of(self, name: str) -> PartTotals:
        """Return the totals of a part."""
        return self.parts.setdefault(name, PartTotals())

    def add(self, name: str, n_done: int, figures: Mapping[str, Any], problems: list[str]) -> None:
        """Add what a slice of a part has measured."""
        part = self.of(name)
        part.n_slices += 1
        part.n_done += n_done
        part.figures = added(part.figures, figures)
        part.problems += problems
        if self._path is not None:
            parts = {name: vars(part) for name, part in self.parts.items()}
            document = {"seed": self._seed, "parts": parts}
            replace_file(self._path, (json.dumps(document, indent=2) + "\n").encode())


def added(
    one: Mapping[str, Any], other: Mapping[str, Any], *, are_largest: bool = False
) -> dict[str, Any]:
    """Return the figures of both: sums, or the largest of those that are no counts."""
    whole = dict(one)
    for name, value in other.items():
        before = whole.get(name)
        is_largest = are_largest or name in _LARGEST
        if before is None:
            whole[name] = value
        elif isinstance(value, Mapping):
            whole[name] = added(before, value, are_largest=is_largest)
        else:
            whole[name] = max(before, value) if is_largest else before + value
    return whole
