"""The table of methods: rows as those of a folder of results, beside those of our runs."""

import csv
import io
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from active_binocular_vision.baselines.bench import Bench
from active_binocular_vision.baselines.command_search import looks_needed
from active_binocular_vision.baselines.methods import SHOWN_LOOKS, Tested
from active_binocular_vision.runs.results_folder import COLUMNS, Row, rows_of_test
from active_binocular_vision.runs.run import Run
from experiment_manager import summary_of
from experiment_manager.measures.criteria import Criteria, criteria_of
from experiment_manager.measures.tables import text_table
from experiment_manager.measures.trials import ERROR_NAMES, Trials
from lockstep import InputError
from lockstep.files.durable_files import replace_file

# Rows of the same test of the same method stand once.
_KEYS = ("run", "profile", "seed")
_WITHIN = "share_within_1_px"
_MEDIANS = tuple(
    f"median_abs_{name}_deg" for name in ("vergence_error", "vertical_error", "cyclovergence_error")
)
_LOOKS = "median_looks_to_1_px"
_SHOWN_AFTER = {"end", *map(str, SHOWN_LOOKS)}


def rows_of_run(run: Run) -> list[Row]:
    """Return the rows of a run's own last test."""
    about = {"run": run.name, "model": run.model, "profile": run.profile, "seed": run.seed}
    about |= {"commit": run.commit[:7]}
    return [*rows_of_test(about, run.summaries[-1], is_of_pair=run.is_of_pair)]


def rows_of_method(
    method: str, run: Run, bench: Bench, tests: Iterable[Tested], commit: str
) -> list[Row]:
    """Return the rows of a method's tests; commit: of the source that made them."""
    about = {"run": method, "model": run.model, "profile": run.profile, "seed": run.seed}
    about |= {"commit": commit[:7]}
    criteria = criteria_of(bench.plant.config)
    return [row for tested in tests for row in _rows(about, run, tested, criteria)]


def _rows(about: Row, run: Run, tested: Tested, criteria: Criteria) -> Iterator[Row]:
    summary = summary_of(tested.trials, criteria)
    rows = [
        row | {"iteration": tested.iteration}
        for row in rows_of_test(about, summary, is_of_pair=run.is_of_pair)
    ]
    if not tested.after:
        yield from rows
    else:  # a search, whose earlier looks have tests of their own
        yield from (row | {"after": tested.after} for row in rows if row["after"] == "end")
        needed = looks_needed(_is_within(tested.trials, criteria.px_deg))
        of = {"iteration": tested.iteration, "trials": "all", "after": tested.after}
        yield about | of | {"measure": _LOOKS, "value": f"{np.median(needed):.9g}"}


def _is_within(trials: Trials, px_deg: float) -> np.ndarray:
    names = ERROR_NAMES[:1] if trials.is_of_pair else ERROR_NAMES[:2]
    return np.all([np.abs(trials.column(name)) < px_deg for name in names], axis=0)


def written(path: Path, rows: Sequence[Row]) -> list[Mapping[str, Any]]:
    """Put rows into a table of comma-separated values, in place of older ones; return them all.

    Raises InputError, having written nothing, for a file that is another table.
    """
    older: list[Mapping[str, Any]] = []
    if path.is_file():
        with path.open(newline="") as file:
            reader = csv.DictReader(file)
            older = [*reader]
        if tuple(reader.fieldnames or ()) != COLUMNS:
            raise InputError(f"{path}: expected a table with columns {', '.join(COLUMNS)}")
    new = {tuple(str(row[key]) for key in _KEYS) for row in rows}
    every = [row for row in older if tuple(row[key] for key in _KEYS) not in new]
    every += [{name: str(row.get(name, "")) for name in COLUMNS} for row in rows]
    text = io.StringIO()
    writer = csv.DictWriter(text, COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(every)
    path.parent.mkdir(parents=True, exist_ok=True)
    replace_file(path, text.getvalue().encode())
    return every


def table(rows: Iterable[Mapping[str, Any]]) -> str:
    """Return errors and share within a pixel of each test, those of the rows' order."""
    tests: dict[tuple[str, ...], dict[str, str]] = {}
    for row in rows:
        if row["trials"] == "all" and row["after"] in _SHOWN_AFTER:
            key = tuple(row[name] for name in ("profile", "run", "seed", "iteration", "after"))
            tests.setdefault(key, {})[row["measure"]] = row["value"]
    header = (
        *("profile", "method", "seed", "learned on", "after", "trials"),
        *("horizontal", "vertical", "cyclovergence", "within 1 px"),
    )
    lines = [
        (*key, of.get("n_trials", ""), *(_degrees(of.get(n)) for n in _MEDIANS), _share(of))
        for key, of in tests.items()
        if _WITHIN in of
    ]
    return text_table(header, lines, n_left=2)


def _degrees(value: str | None) -> str:
    return f"{float(value):.3f}" if value else "-"


def _share(measures: Mapping[str, str]) -> str:
    return f"{100.0 * float(measures[_WITHIN]):.1f} %"
