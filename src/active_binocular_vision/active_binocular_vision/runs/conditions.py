"""Conditions: runs that differ in their seeds alone, and columns of measures of them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from active_binocular_vision.examinations.contract.measure import SHARE, Measure, columns_of
from active_binocular_vision.examinations.registry import EXAMINATIONS
from active_binocular_vision.runs.examined_run import END, TEST, ExaminedRun, OwnTest
from active_binocular_vision.runs.groups import Common, differences
from experiment_manager.measures.tables import number
from lockstep import InputError
from lockstep.written.nearest import did_you_mean

# By the name of the profile that has the condition.
NAMES: Mapping[str, str] = {
    **{f"{way}tropia_{n}": f"{way}tropia {n}°" for way in ("eso", "exo") for n in (5, 10, 20)},
    **{f"anisometropia_{n}": f"anisometropia {n} px" for n in (2, 4, 8)},
    "patching": "glasses, patching",
    "patching_half": "glasses, patching half",
    "vertical": "vertical stripes",
    "horizontal": "horizontal stripes",
    "orthogonal": "orthogonal stripes",
    "monocular": "one eye deprived",
    **{f"strabismus_camera_{n}deg": f"camera turned by {n}°" for n in (3, 10)},
    **{f"strabismus_camera_{n}deg_still": f"camera {n}°, still eyes" for n in (3, 10)},
    **{f"aniseikonia_{n}": f"right image {n}\N{NO-BREAK SPACE}% larger" for n in (10, 15, 25)},
}


class Range(NamedTuple):
    """Median, least and greatest, as they are shown, over the n seeds that have a value."""

    median: float
    least: float
    greatest: float
    n: int


@dataclass(frozen=True)
class Column:
    """A measure of an examination's summary, or of the run's own test.

    heading: what tables and figures call it, with the unit.
    """

    examination: str
    measure: str
    declared: Measure
    heading: str

    @property
    def factor(self) -> float:
        """What values are multiplied with to be shown."""
        return 100.0 if self.declared.unit == SHARE else 1.0

    def cell(self, found: Range | None, n_seeds: int) -> str:
        """Return what a table shows of the seeds of a condition."""
        if found is None:
            return "-"
        n_digits = 0 if self.declared.unit == SHARE else self.declared.n_digits
        median, least, greatest = (number(value, n_digits) for value in found[:3])
        notes = [f"{least} to {greatest}"] if found.n > 1 else []
        notes += [f"{found.n} of {n_seeds}"] if found.n < n_seeds else []
        return f"{median} ({'; '.join(notes)})" if notes else median


def all_columns() -> dict[str, Column]:
    """Return every column by its name, EXAMINATION.MEASURE."""
    summaries: dict[str, Any] = {TEST: OwnTest}
    summaries |= {name: examination.summary for name, examination in EXAMINATIONS.items()}
    return {
        f"{examination}.{name}": Column(
            examination,
            name,
            declared,
            heading.partition("/")[0] + " / %" if declared.unit == SHARE else heading,
        )
        for examination, summary in summaries.items()
        for name, (declared, heading) in columns_of(summary).items()
    }


def chosen_columns(text: str) -> list[Column]:
    """Return the columns that a text with commas names: EXAMINATION for all of its, or one.

    Raises InputError for another name.
    """
    columns = all_columns()
    chosen: dict[str, Column] = {}
    for name in text.split(","):
        some = {n: c for n, c in columns.items() if name in (n, c.examination)}
        if not some:
            raise InputError(
                f"--columns: expected EXAMINATION or EXAMINATION.MEASURE, got {name!r}"
                + did_you_mean(name, [*columns, *{c.examination for c in columns.values()}])
            )
        chosen |= some
    return list(chosen.values())


@dataclass(frozen=True)
class Condition:
    """A condition; runs: its seeds."""

    name: str
    runs: tuple[ExaminedRun, ...]

    def over_seeds(self, age: str, column: Column) -> Range | None:
        """Return a measure at an age over the seeds, None where no seed has it."""
        found = [run.value(age, column.examination, column.measure) for run in self.runs]
        values = [value for value in found if value is not None]
        if not values:
            return None
        factor, median = column.factor, float(np.median(values))
        return Range(factor * median, factor * min(values), factor * max(values), len(values))

    def tables(self, examination: str, name: str) -> list[Sequence[Mapping[str, Any]]]:
        """Return a table of an examination at the end, of the seeds that have it."""
        tables = [run.table(END, examination, name) for run in self.runs]
        return [rows for rows in tables if rows]


def conditions_of(runs: Sequence[ExaminedRun]) -> list[Condition]:
    """Return the conditions of runs, in the order of their first runs.

    A name says what other conditions differ in: the age of the change and the dictionaries, if that
    is not the same in all of one profile, the model, if there are two, and lambda and settings,
    where conditions would have the same name otherwise.
    """
    by_key: dict[Common, list[ExaminedRun]] = {}
    for run in runs:
        by_key.setdefault(run.common, []).append(run)
    firsts = [of_key[0] for of_key in by_key.values()]
    names = {first.common: _name(first, firsts) for first in firsts}
    conditions = []
    for key, of_key in by_key.items():
        alike = [other for other, name in names.items() if name == names[key]]
        has_weights = len({other.weight for other in alike}) > 1
        weight = [f"\N{GREEK SMALL LETTER LAMDA} = {key.weight:.3g} / W"] * has_weights
        name = ", ".join([names[key], *weight, *differences(key, alike)])
        conditions.append(Condition(name, tuple(of_key)))
    return conditions


def _name(run: ExaminedRun, others: Sequence[ExaminedRun]) -> str:
    alike = [other for other in others if other.condition == run.condition]
    parts = [NAMES.get(run.condition, run.condition.replace("_", " "))]
    if len({other.iterations for other in alike}) > 1:
        parts.append(f"{run.iterations:,} iterations")
    if run.changed_at and len({other.changed_at[:1] for other in alike}) > 1:
        share = 100.0 * run.changed_at[0] / run.iterations
        parts.append(f"at {share:.0f}\N{NO-BREAK SPACE}%")
    if len({other.final_learning_rate for other in alike}) > 1:
        parts.append("plastic" if run.final_learning_rate else "frozen")
    if len({other.model for other in others}) > 1:
        parts.append(run.model)
    return ", ".join(parts)
