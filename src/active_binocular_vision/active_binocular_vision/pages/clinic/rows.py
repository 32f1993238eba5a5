"""Runs that differ in their seeds alone, as one row of the page."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from active_binocular_vision.runs.examined_run import ExaminedRun
from active_binocular_vision.runs.groups import Common, own_settings

# By the name of the profile that has the condition.
NAMES = {
    **{f"{way}tropia_{n}": f"{way}tropia {n}°" for way in ("eso", "exo") for n in (5, 10, 20)},
    **{f"anisometropia_{n}": f"anisometropia {n} px" for n in (2, 4, 8)},
    "patching": "glasses, patching",
    "patching_half": "glasses, patching half",
}


class Range(NamedTuple):
    """Median, least and greatest over the n seeds that have a value."""

    median: float
    least: float
    greatest: float
    n: int


@dataclass(frozen=True)
class Row:
    """A condition; runs: its seeds."""

    name: str
    runs: tuple[ExaminedRun, ...]

    def over_seeds(self, when: str, measure: str) -> Range | None:
        """Return a measure of ExaminedAge at an age over the seeds, None where no seed has it."""
        ages = [age for run in self.runs if (age := run.at(when)) is not None]
        values = [value for age in ages if (value := getattr(age, measure)) is not None]
        if not values:
            return None
        return Range(float(np.median(values)), min(values), max(values), len(values))


def rows_of(runs: Sequence[ExaminedRun], common: Sequence[Common]) -> list[Row]:
    """Return the rows of runs, in the order of their first runs.

    common: what each run has in common with those that differ in their seeds alone. A name says
    what other rows differ in: the age of the change and the dictionaries, if that is not the same
    in all rows of the condition, the model, if there are two, and lambda and settings, where rows
    would have the same name otherwise.
    """
    by_key: dict[Common, list[ExaminedRun]] = {}
    for run, key in zip(runs, common, strict=True):
        by_key.setdefault(key, []).append(run)
    firsts = [of_key[0] for of_key in by_key.values()]
    names = {key: _name(of_key[0], firsts) for key, of_key in by_key.items()}
    return [Row(_full_name(key, names), tuple(of_key)) for key, of_key in by_key.items()]


def _full_name(key: Common, names: Mapping[Common, str]) -> str:
    alike = [other for other, name in names.items() if name == names[key]]
    parts = [names[key]]
    if len({other.weight for other in alike}) > 1:
        parts.append(f"\N{GREEK SMALL LETTER LAMDA} = {key.weight:.3g} / W")
    return ", ".join([*parts, *own_settings(key, alike)])


def _name(run: ExaminedRun, others: Sequence[ExaminedRun]) -> str:
    alike = [other for other in others if other.condition == run.condition]
    parts = [NAMES.get(run.condition, run.condition.replace("_", " "))]
    if len({other.iterations for other in alike}) > 1:
        parts.append(f"{run.iterations:,} iterations")
    if run.changed_at is not None and len({other.changed_at for other in alike}) > 1:
        parts.append(f"at {100.0 * run.changed_at / run.iterations:.0f}\N{NO-BREAK SPACE}%")
    if len({other.final_learning_rate for other in alike}) > 1:
        parts.append("plastic" if run.final_learning_rate else "resting")
    if len({other.model for other in others}) > 1:
        parts.append(run.model)
    return ", ".join(parts)
