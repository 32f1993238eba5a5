"""The tables of a report: K17's numbers beside those of the runs."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from experiment_manager.measures.metrics import REPORTED_ITERATIONS, summary
from experiment_manager.measures.recorded_run import RecordedRun
from experiment_manager.measures.resting_places import resting_places
from experiment_manager.measures.tables import number, percent
from experiment_manager.measures.trials import TestTrials, pooled
from experiment_manager.report import page as report_page
from experiment_manager.report.groups import Group


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


# The rows of a test set, and how each is read from its summary.
_SHOWN: dict[str, Callable[[dict[str, Any]], str]] = {
    "trials": lambda told: f"{told['n_trials']:,}",
    "median |error| / deg": lambda told: number(told["median_abs_vergence_error_deg"]),
    "IQR of |error| / deg": lambda told: number(told["iqr_abs_vergence_error_deg"]),
    "median Delta C / W": lambda told: number(told["median_delta_cost_w"]),
    "median c": lambda told: percent(told["median_cost_reduction"]),
    "within 1 px": lambda told: percent(told["share_within_1_px"]),
    "beyond 1 deg": lambda told: percent(told["share_beyond_1_deg"]),
    "right muscle silent": lambda told: percent(told["share_right_muscle_silent"]),
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
            *(percent(share) for share in run.cost_shares),
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
    names = ["training iterations", "runs pooled", "lambda / per W"]
    names += [
        f"{which}: {measure}"
        for which in ("our test set", "authors' test set")
        for measure in _SHOWN
    ]
    rows = [(name, *cells) for name, *cells in zip(names, *columns, strict=True)]
    return report_page.table(header, rows)


def _paper_column(paper: _Paper) -> list[str]:
    stated = ["7,800", paper.median_deg, paper.iqr_deg, "-", paper.cost_reduction]
    return [
        paper.n_iterations,
        "5",
        paper.weight,
        *["-"] * len(_SHOWN),
        *stated,
        *["-"] * (len(_SHOWN) - len(stated)),
    ]


def _column(group: Group) -> list[str]:
    ours = summary(_last_trials(group))
    return [
        f"{group.iterations[-1]:,}",
        str(len(group.runs)),
        f"{group.runs[0].metabolic_cost_weight:.4g}",
        *(text(told) for told in (ours, ours["authors_test_set"]) for text in _SHOWN.values()),
    ]


def _last_trials(group: Group) -> TestTrials:
    return pooled([test.trials for test in group.tests_at(group.iterations[-1])])


def bias_table(groups: Sequence[Group]) -> str:
    """Return the median signed error of each group's last test by object distance."""
    biases_deg = [summary(_last_trials(group))["bias_by_distance_deg"] for group in groups]
    distances = sorted({d for bias_deg in biases_deg for d in bias_deg}, key=float)
    rows = [
        (group.model, *(number(bias_deg.get(d)) for d in distances))
        for group, bias_deg in zip(groups, biases_deg, strict=True)
    ]
    return report_page.table(("bias / deg at", *(f"{d} m" for d in distances)), rows)


def iterations_table(groups: Sequence[Group]) -> str:
    """Return each group's measures after 1, 2, 3 and 20 iterations of the last test."""
    header = (
        "model",
        "trained for",
        "after",
        "median |error| / deg",
        "IQR / deg",
        "within 1 px",
        "beyond 1 deg",
        "median c",
    )
    rows = []
    for group in groups:
        trials = _last_trials(group)
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
                    percent(told["share_within_1_px"]),
                    percent(told["share_beyond_1_deg"]),
                    percent(told["median_cost_reduction"]),
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
        "within 1 px",
        "beyond 1 deg",
        "median Delta C / W",
        "median c",
        "right muscle silent",
        "authors' test set: median |error| / deg",
        "authors' test set: IQR / deg",
    )
    rows = []
    for told in (summary(test.trials) for test in run.tests):
        authors = told["authors_test_set"]
        rows.append(
            (
                f"{told['iteration']:,}",
                str(told["n_trials"]),
                number(told["median_abs_vergence_error_deg"]),
                number(told["iqr_abs_vergence_error_deg"]),
                percent(told["share_within_1_px"]),
                percent(told["share_beyond_1_deg"]),
                number(told["median_delta_cost_w"]),
                percent(told["median_cost_reduction"]),
                percent(told["share_right_muscle_silent"]),
                number(authors["median_abs_vergence_error_deg"]),
                number(authors["iqr_abs_vergence_error_deg"]),
            )
        )
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
