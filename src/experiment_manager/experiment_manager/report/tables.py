"""The tables of a report: K17's numbers beside those of the runs."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from experiment_manager.measures.metrics import REPORTED_ITERATIONS, TestTrials, summary
from experiment_manager.measures.recorded_run import RecordedRun, RecordedTest
from experiment_manager.measures.resting_places import resting_places
from experiment_manager.measures.tables import number
from experiment_manager.report import page as report_page
from experiment_manager.report.groups import Group
from experiment_manager.report.performance_figures import PX_DEG

# Below this a muscle counts as silent: its cost no longer falls (the floor of its cost).
_SILENT = 0.005


@dataclass(frozen=True)
class _Paper:
    """What K17 III states of a model, as text; figures only give the rest."""

    n_iterations: str
    weight: str
    median_deg: str
    iqr_deg: str
    cost_reduction: str


_PAPER = {
    "M": _Paper("1,000,000", "0", "0.07", "0.080", "single digits"),
    "M_C": _Paper("1,000,000", "0.035", "0.176", "0.269", "101.7 %"),
}


def runs_table(groups: Sequence[Group]) -> str:
    """Return one line per run: what it is, lambda and its share of the reward."""
    header = (
        "run",
        "model",
        "seed",
        "iterations",
        "lambda / per W",
        "share, first 5,000",
        "share, last 5,000",
        "commit",
    )
    rows = [
        (
            run.name,
            run.model,
            str(run.seed),
            f"{run.n_iterations:,}",
            f"{run.metabolic_cost_weight:.4g}",
            *(_percent(share) for share in run.cost_shares),
            run.commit[:12] or "unknown",
        )
        for group in groups
        for run in group.runs
    ]
    return report_page.table(header, rows)


def comparison_table(groups: Sequence[Group]) -> str:
    """Return the paper's measures beside those of each group's last test, trials pooled."""
    header = ["measure"]
    columns: list[list[str]] = []
    for group in groups:
        if group.model in _PAPER and f"paper, {group.model}" not in header:
            header.append(f"paper, {group.model}")
            columns.append(_paper_column(_PAPER[group.model]))
        header.append(f"ours, {group.model}")
        columns.append(_column(group))
    names = (
        "training iterations",
        "runs pooled",
        "trials",
        "lambda / per W",
        "median |error| / deg",
        "IQR of |error| / deg",
        "median Delta C / W",
        "median c",
        "without zero start errors: median |error| / deg",
        "without zero start errors: IQR / deg",
        "without zero start errors: median c",
        "trials within 1 px",
        "trials that end with a silent muscle",
    )
    rows = [(name, *cells) for name, *cells in zip(names, *columns, strict=True)]
    return report_page.table(header, rows)


def _paper_column(paper: _Paper) -> list[str]:
    return [
        paper.n_iterations,
        "5",
        "7,800",
        paper.weight,
        paper.median_deg,
        paper.iqr_deg,
        "-",
        paper.cost_reduction,
        *["-"] * 5,
    ]


def _column(group: Group) -> list[str]:
    tests = group.tests_at(group.iterations[-1])
    trials = pooled(tests)
    all_trials = summary(trials)
    moved = all_trials["without_zero_start_error"]
    final = np.concatenate([test.activations[:, -1] for test in tests])
    return [
        f"{group.iterations[-1]:,}",
        str(len(group.runs)),
        f"{all_trials['n_trials']:,}",
        f"{group.runs[0].metabolic_cost_weight:.4g}",
        number(all_trials["median_abs_vergence_error_deg"]),
        number(all_trials["iqr_abs_vergence_error_deg"]),
        number(all_trials["median_delta_cost_w"]),
        _percent(all_trials["median_cost_reduction"]),
        number(moved["median_abs_vergence_error_deg"]),
        number(moved["iqr_abs_vergence_error_deg"]),
        _percent(moved["median_cost_reduction"]),
        _percent(_share_within_px(trials, trials.n_iterations)),
        _percent(float((final.min(axis=1) < _SILENT).mean())),
    ]


def iterations_table(groups: Sequence[Group]) -> str:
    """Return each group's measures after 1, 2, 3 and 20 iterations of the last test."""
    header = (
        "model",
        "trained for",
        "after",
        "median |error| / deg",
        "IQR / deg",
        "within 1 px",
        "median c",
    )
    rows = []
    for group in groups:
        trials = pooled(group.tests_at(group.iterations[-1]))
        whole = summary(trials)
        for k in (k for k in REPORTED_ITERATIONS if k <= trials.n_iterations):
            told = whole.get(f"after_{k}", whole)
            rows.append(
                (
                    group.model,
                    f"{trials.training_iteration:,}",
                    str(k),
                    number(told["median_abs_vergence_error_deg"]),
                    number(told["iqr_abs_vergence_error_deg"]),
                    _percent(_share_within_px(trials, k)),
                    _percent(told["median_cost_reduction"]),
                )
            )
    return report_page.table(header, rows)


def tests_of_run_table(run: RecordedRun) -> str:
    """Return a run's tests, as in its results.json."""
    header = (
        "iteration",
        "trials",
        "median |error| / deg",
        "IQR / deg",
        "median Delta C / W",
        "median c",
    )
    shown: tuple[tuple[str, Callable[[float | None], str]], ...] = (
        ("median_abs_vergence_error_deg", number),
        ("iqr_abs_vergence_error_deg", number),
        ("median_delta_cost_w", number),
        ("median_cost_reduction", _percent),
    )
    tests = [summary(test.trials) for test in run.tests]
    rows = [
        (f"{test['iteration']:,}", str(test["n_trials"]), *(text(test[key]) for key, text in shown))
        for test in tests
    ]
    return report_page.table(header, rows)


def resting_table(run: RecordedRun) -> str:
    """Return where the trials of a run's tests come to rest."""
    header = (
        "iteration",
        "trials at rest",
        "bias / deg",
        "SD / deg",
        "SD within picture and distance / deg",
        "SD between them / deg",
        "SD over time / deg",
        "share left by an iteration",
    )
    rows = []
    for test in run.tests:
        rest = resting_places(test.trials)
        rows.append(
            (
                f"{test.trials.training_iteration:,}",
                str(rest.n_trials),
                *(number(value) for value in list(vars(rest).values())[1:]),
            )
        )
    return report_page.table(header, rows)


def pooled(tests: Sequence[RecordedTest]) -> TestTrials:
    """Return the trials of several runs' tests as if they were of one."""
    parts = [test.trials for test in tests]
    names = [name for name, value in vars(parts[0]).items() if isinstance(value, np.ndarray)]
    joined = {name: np.concatenate([getattr(part, name) for part in parts]) for name in names}
    return TestTrials(training_iteration=parts[0].training_iteration, **joined)


def _share_within_px(trials: TestTrials, iteration: int) -> float:
    return float((np.abs(trials.vergence_error_deg[:, iteration]) < PX_DEG).mean())


def _percent(share: float | None) -> str:
    return "-" if share is None else f"{100 * share:.1f} %"
