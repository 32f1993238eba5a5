"""A folder of results: what stays of finished runs, in a few files that other tools read.

measures.csv       a row per run, test and measure; docs: results/README.md
runs.yaml          config.yaml of all runs: what they have in common, and how each differs
trials.npz         trials of their tests, where these are kept
examinations.json  what was found in the learners of each run, by run
"""

import contextlib
import csv
import json
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Any, Self

import msgspec
import numpy as np
import yaml

from active_binocular_vision.runs.run import EXAMINATIONS_FILE, Run
from experiment_manager.measures.kept_trials import KEPT_FILE, KeptTrials, arrays_of, from_arrays
from experiment_manager.measures.results import (
    CostShares,
    Measures,
    Results,
    SetSummary,
    Summary,
)
from experiment_manager.run.config_file import CONFIG_FILE, RUN_SECTION, without_gone
from experiment_manager.sections import Configuration, by_key
from experiment_manager.sweep.sweep_file import SWEEP_FILE, read_sweep
from experiment_manager.trained.directory import run_directory
from lockstep import InputError, read_state, write_state
from lockstep.files.durable_files import replace_file

MEASURES_FILE, RUNS_FILE = "measures.csv", "runs.yaml"
COLUMNS = (
    *("run", "model", "profile", "seed", "commit", "shown"),
    *("iteration", "trials", "after", "measure", "value"),
)
_KIND = "trials_of_runs"
_ALL, _UP_TO_2_DEG, _AFTER = "all", "starts_up_to_2_deg", "after_"
_SHARE = "lambda_share"
_COMMON, _RUNS = "common", "runs"
_ERROR = "median_abs_vergence_error_deg"
# What is kept of a run's last test alone, besides p90 and measures after an iteration but _ERROR.
_OF_LAST_TEST = {
    "bias_by_distance_deg",
    "median_abs_version_deg",
    "median_left_deviation_deg",
    "median_right_deviation_deg",
    "antagonists",
}
_BY_DISTANCE = "active_by_distance"
# Bits of the 24 of a float32 that are kept of a trial's numbers: 2e-6 of each.
_N_BITS = 18

Row = dict[str, Any]


class KeptRun(Run):
    """A run of a folder of results."""

    def __init__(self, folder: "ResultsFolder", name: str) -> None:
        """name: of the run in the folder."""
        super().__init__(folder.directory / name)
        self._folder = folder

    def unread(self) -> Run:
        """Return the run without its folder and trials, with what examining needs."""
        run, names = super().unread(), ("about", "configuration", "document", "examinations")
        vars(run).update({name: getattr(self, name) for name in names})
        return run

    @cached_property
    def configuration_text(self) -> str:
        """What stands for config.yaml."""
        return yaml.safe_dump({RUN_SECTION: self.about, **self.configuration}, sort_keys=False)

    @cached_property
    def about(self) -> Mapping[str, Any]:
        """What the run is."""
        return self._folder.configurations[self.name][RUN_SECTION]

    @cached_property
    def configuration(self) -> Configuration:
        """All parameters by section, by dotted name."""
        sections = self._folder.configurations[self.name]
        return without_gone({name: of for name, of in sections.items() if name != RUN_SECTION})

    @cached_property
    def document(self) -> Results:
        """What results.json said, as far as it is kept."""
        return _results(self, self._folder.rows.get(self.name, []))

    @cached_property
    def kept_trials(self) -> KeptTrials | None:
        """What is kept of the trials."""
        return self._folder.trials.get(self.name)

    @cached_property
    def examinations(self) -> Mapping[str, Any]:
        """What was found in the learners."""
        return self._folder.examinations.get(self.name, {"examined": []})


class ResultsFolder:
    """Reads a folder of results, each file once."""

    def __init__(self, directory: Path) -> None:
        """directory: with runs.yaml."""
        self.directory = directory

    @classmethod
    def at(cls, directory: Path) -> Self | None:
        """Return the folder, None for another directory."""
        return cls(directory) if (directory / RUNS_FILE).is_file() else None

    def runs(self) -> list[Run]:
        """Return the runs; InputError for a damaged file."""
        return [KeptRun(self, name) for name in self.configurations]

    @cached_property
    def configurations(self) -> dict[str, Configuration]:
        """config.yaml of each run by section."""
        path = self.directory / RUNS_FILE
        try:
            document = yaml.load(path.read_text(), Loader=yaml.CSafeLoader)
            common, runs = document[_COMMON], document[_RUNS]
            return {
                name: {of: common.get(of, {}) | own.get(of, {}) for of in {**common, **own}}
                for name, own in runs.items()
            }
        except (OSError, yaml.YAMLError, KeyError, TypeError, AttributeError) as error:
            raise InputError(f"{path}: expected the configurations of runs: {error}") from error

    @cached_property
    def rows(self) -> dict[str, list[Row]]:
        """Rows of measures.csv by run."""
        by_run: dict[str, list[Row]] = {}
        path = self.directory / MEASURES_FILE
        with path.open(newline="") as file:
            for row in csv.DictReader(file):
                by_run.setdefault(row["run"], []).append(row)
        return by_run

    @cached_property
    def trials(self) -> dict[str, KeptTrials | None]:
        """What is kept of the trials of each run."""
        path = self.directory / KEPT_FILE
        by_run: dict[str, dict[str, np.ndarray]] = {}
        for key, values in (read_state(path, _KIND) if path.is_file() else {}).items():
            run, _, name = key.partition("/")
            by_run.setdefault(run, {})[name] = values
        return {run: from_arrays(arrays) for run, arrays in by_run.items()}

    @cached_property
    def examinations(self) -> dict[str, Any]:
        """What was found in the learners, by run."""
        path = self.directory / EXAMINATIONS_FILE
        return json.loads(path.read_bytes()) if path.is_file() else {}


def runs_at(path: Path) -> list[Run]:
    """Return the runs of a folder of results, or those of a sweep in its order; else the one there.

    A run of a folder of results is named as if it were a directory there.
    """
    path = run_directory(path)
    for folder, name in ((ResultsFolder.at(path), ""), (ResultsFolder.at(path.parent), path.name)):
        if folder is not None:
            return [run for run in folder.runs() if name in ("", run.name)]
    if not (path / SWEEP_FILE).is_file():
        return [Run(path)]
    runs = {str(file.parent.relative_to(path)): file.parent for file in path.rglob(CONFIG_FILE)}
    in_order: list[str] = []
    with contextlib.suppress(InputError):
        in_order = [*read_sweep(path / SWEEP_FILE).runs()]
    names = dict.fromkeys([*in_order, *sorted(runs)])
    return [Run(runs[name]) for name in names if name in runs]


def runs_with_tests(paths: Sequence[Path]) -> tuple[list[Run], list[str]]:
    """Return the runs at paths, and in the sweeps there, that have a test; why others are left out.

    Raises InputError when none has, with what is wrong with the first.
    """
    runs: dict[Path, Run] = {}
    reasons: list[str] = []
    for path in paths:
        try:
            for run in runs_at(path):
                try:
                    if not (run.summaries and run.about):
                        raise InputError(f"{run.directory}: expected at least one complete test")
                    runs[run.directory.resolve()] = run
                except InputError as error:
                    reasons.append(str(error))
        except InputError as error:
            reasons.append(str(error))
    if not runs:
        raise InputError(reasons[0] if reasons else f"{paths[0]}: expected runs in the sweep")
    return [*runs.values()], reasons


def keep(runs: Sequence[Run], directory: Path, *, with_trials: bool = True) -> None:
    """Write a folder of results; of the trials nothing where with_trials is False.

    Raises InputError for a damaged run or two of one name, OSError when the disk refuses.
    """
    of_name: dict[str, Run] = {}
    for run in runs:
        if (other := of_name.setdefault(run.name, run)) is not run:
            raise InputError(
                f"{directory}: expected runs of different names, got {other.directory} and"
                f" {run.directory}"
            )
    directory.mkdir(parents=True, exist_ok=True)
    sections = {run.name: {RUN_SECTION: dict(run.about)} | run.configuration for run in runs}
    common, own = _common_and_own(sections)
    text = yaml.safe_dump({_COMMON: common, _RUNS: own}, sort_keys=False, width=100)
    replace_file(directory / RUNS_FILE, text.encode())
    with (directory / MEASURES_FILE).open("w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        for run in runs:
            writer.writerows(_rows(run))
    kept = {run.name: run.kept_trials for run in runs} if with_trials else {}
    arrays = {
        f"{name}/{key}": _rounded(values)
        for name, of in kept.items()
        for key, values in arrays_of(of).items()
    }
    if arrays:
        write_state(directory / KEPT_FILE, _KIND, arrays)
    examined = {run.name: run.examinations for run in runs if run.examinations["examined"]}
    if examined:
        lines = ",\n".join(f"{json.dumps(n)}: {_rounded_json(of)}" for n, of in examined.items())
        replace_file(directory / EXAMINATIONS_FILE, f"{{\n{lines}\n}}\n".encode())


def _rounded_json(document: Any) -> str:
    def rounded(value: Any) -> Any:
        if isinstance(value, float):
            return float(f"{value:.6g}")
        if isinstance(value, dict):
            return {key: rounded(inner) for key, inner in value.items()}
        return [rounded(inner) for inner in value] if isinstance(value, list) else value

    return json.dumps(rounded(document))


def _rounded(values: np.ndarray) -> np.ndarray:
    """Return float32 with fewer bits, which compress; other numbers as they are."""
    if values.dtype != np.float32:
        return values
    dropped = 24 - _N_BITS
    half = np.uint32(1 << (dropped - 1))
    bits = (values.view(np.uint32) + half) >> np.uint32(dropped) << np.uint32(dropped)
    return np.where(np.isfinite(values), bits.view(np.float32), values)


def _common_and_own(
    of_runs: Mapping[str, Configuration],
) -> tuple[Configuration, dict[str, Configuration]]:
    """Return the parameters that all runs have alike, and the others of each, by section."""
    flat = {run: by_key(sections) for run, sections in of_runs.items()}
    first, *others = flat.values()
    common = {
        key: value
        for key, value in first.items()
        if all(key in other and other[key] == value for other in others)
    }
    own = {run: {k: v for k, v in of.items() if k not in common} for run, of in flat.items()}
    return _by_section(common), {run: _by_section(values) for run, values in own.items()}


def _by_section(values: Mapping[str, Any]) -> Configuration:
    found: Configuration = {}
    for key, value in values.items():
        section, _, name = key.partition(".")
        found.setdefault(section, {})[name] = value
    return found


# Rows of measures.csv


def _rows(run: Run) -> Iterator[Row]:
    """Yield what is kept of a run's tests: of the last one all measures."""
    about = {"run": run.name, "model": run.model, "profile": run.profile, "seed": run.seed}
    about |= {"commit": run.commit[:7]}
    shares = msgspec.to_builtins(run.document.cost_shares)
    for end, value in shares.items():
        of = about | {"iteration": run.n_iterations, "trials": "training"}
        yield _row(of, "", f"{_SHARE}/{end}", value)
    for test in run.summaries:
        is_last = test is run.summaries[-1]
        yield from rows_of_test(about, test, is_of_pair=run.is_of_pair, is_last=is_last)
    for shown, document in run.tests_of_learners.items():
        for test in document:
            yield from rows_of_test(about | {"shown": shown}, test, is_of_pair=run.is_of_pair)


def rows_of_test(
    about: Row, test: Summary, *, is_of_pair: bool, is_last: bool = True
) -> Iterator[Row]:
    """Yield what is kept of a test: of a run's last one all measures.

    about: the columns that say what the test is of.
    """
    document = msgspec.to_builtins(test)
    about = about | {"iteration": document.pop("iteration")}
    document.pop("without_zero_start_error")
    sets = {_ALL: document, _UP_TO_2_DEG: document.pop("starts_up_to_2_deg")}
    for name, of_set in sets.items() if is_of_pair else [(_ALL, document)]:
        of = about | {"trials": name}
        for key, value in of_set.items():
            if key.startswith(_AFTER):
                for measure, early in value.items():
                    if is_last or measure == _ERROR:
                        yield _row(of, key.removeprefix(_AFTER), measure, early)
            elif is_last or key not in _OF_LAST_TEST:
                for measure, leaf in _leaves(value, key):
                    part = measure.rpartition("/")[2]
                    if leaf is not None and (is_last or part != "p90"):
                        yield _row(of, "end", measure, leaf)


def _row(about: Row, after: str, measure: str, value: Any) -> Row:
    text = f"{value:.9g}" if isinstance(value, float) else value
    return about | {"after": after, "measure": measure, "value": text}


def _leaves(value: Any, path: str) -> Iterator[tuple[str, Any]]:
    if not isinstance(value, dict):
        yield path, value
        return
    for key, inner in value.items():
        if key != _BY_DISTANCE:
            yield from _leaves(inner, f"{path}/{key}")


def _results(run: Run, rows: Sequence[Row]) -> Results:
    """Return what the rows of a run say."""
    try:
        tests, shares = _parsed(rows)
        return run.results_with(
            CostShares(**shares),
            tuple(_test(iteration, sets) for iteration, sets in sorted(tests.items())),
        )
    except (TypeError, ValueError, KeyError) as error:
        raise InputError(f"{run.directory}: expected its measures: {error}") from error


def _parsed(
    rows: Sequence[Row],
) -> tuple[dict[int, dict[str, dict[str, Any]]], dict[str, float | None]]:
    """Return the measures of tests by training iteration and set of trials, and cost shares."""
    tests: dict[int, dict[str, Any]] = {}
    shares: dict[str, float | None] = {}
    for row in rows:
        value = json.loads(row["value"]) if row["value"] else None
        path = row["measure"].split("/")
        if path[0] == _SHARE:
            shares[path[1]] = value
        elif not row["shown"]:
            of_sets = tests.setdefault(int(row["iteration"]), {_ALL: {}, _UP_TO_2_DEG: {}})
            at = of_sets[row["trials"]]
            if row["after"] != "end":
                path = [f"{_AFTER}{row['after']}", *path]
            for key in path[:-1]:
                at = at.setdefault(key, {})
            at[path[-1]] = value
    return tests, shares


def _test(iteration: int, sets: Mapping[str, dict[str, Any]]) -> Summary:
    of_all = _completed(sets[_ALL])
    of_sets = {
        "without_zero_start_error": _completed({}),
        "starts_up_to_2_deg": _completed(sets[_UP_TO_2_DEG]),
    }
    return msgspec.convert(of_all | of_sets | {"iteration": iteration}, Summary)


def _completed(of_set: Mapping[str, Any]) -> dict[str, Any]:
    """Return the measures of a set of trials, None for those that are not kept."""
    none = dict.fromkeys(_required(SetSummary)) | {"n_trials": 0, "bias_by_distance_deg": {}}
    early = {
        key: dict.fromkeys(_required(Measures)) | value
        for key, value in of_set.items()
        if key.startswith(_AFTER)
    }
    return none | dict(of_set) | early


def _required(struct: type[msgspec.Struct]) -> list[str]:
    return [field.name for field in msgspec.structs.fields(struct) if field.required]
