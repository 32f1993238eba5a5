"""The tables of a report: K17's numbers beside those of the runs."""

import statistics
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from experiment_manager.analysis.recorded_run import RecordedRun
from experiment_manager.analysis.report import page as report_page
from experiment_manager.analysis.report.groups import Group
from experiment_manager.analysis.report.reported_run import ReportedRun
from experiment_manager.analysis.resting_places import resting_places
from experiment_manager.measures.metrics import REPORTED_ITERATIONS, SHARE_ITERATIONS
from experiment_manager.measures.tables import number, percent


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
    "median |vergence error| / deg": lambda told: number(told["median_abs_vergence_error_deg"]),
    "IQR of |vergence error| / deg": lambda told: number(told["iqr_abs_vergence_error_deg"]),
    "median Delta C / W": lambda told: number(told["median_delta_cost_w"]),
    "median c": lambda told: percent(told["median_cost_reduction"]),
    "within 1 px": lambda told: percent(told.get("share_within_1_px")),
    "beyond 1 deg": lambda told: percent(told.get("share_beyond_1_deg")),
    "right muscle silent": lambda told: percent(told.get("share_right_muscle_silent")),
}


def runs_table(groups: Sequence[Group]) -> str:
    """Return one line per run: what it is, lambda and its share of the reward.

    The share is over the first and the last 5,000 iterations, of a shorter run over all.
    """
    header = (
        "run",
        "model",
        "profile",
        "seed",
        "iterations",
        "lambda / per W",
        "lambda's share at the start",
        "at the end",
        "commit",
    )
    rows = [
        (
            run.name,
            run.model,
            run.profile or "-",
            str(run.seed),
            f"{run.n_iterations:,}",
            f"{run.metabolic_cost_weight:.4g}",
            *(_share_of_reward(share, run.n_iterations) for share in run.cost_shares),
            run.commit[:12] or "unknown",
        )
        for group in groups
        for run in group.runs
    ]
    return report_page.table(header, rows)


def _share_of_reward(share: float | None, n_iterations: int) -> str:
    """Return the share; of a run that is shorter than what it is told over, over what it is."""
    whole = n_iterations >= SHARE_ITERATIONS or share is None
    return percent(share) if whole else f"{percent(share)} (all {n_iterations:,})"


def comparison_table(groups: Sequence[Group]) -> str:
    """Return the paper's measures beside those of each group's last test, trials pooled."""
    header = ["measure"]
    columns: list[list[str]] = []
    for group in groups:
        if group.model in _PAPER and f"paper, {group.model}" not in header:
            header.append(f"paper, {group.model}")
            columns.append(_paper_column(_PAPER[group.model]))
        header.append(f"ours, {group.name}")
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
    stated = ["-", paper.median_deg, paper.iqr_deg, "-", paper.cost_reduction]
    return [
        paper.n_iterations,
        "5",
        paper.weight,
        *["-"] * len(_SHOWN),
        *stated,
        *["-"] * (len(_SHOWN) - len(stated)),
    ]


def _column(group: Group) -> list[str]:
    ours = group.last_summary or {}
    authors = ours.get("authors_test_set")
    return [
        f"{group.iterations[-1]:,}",
        str(len(group.runs)),
        f"{group.runs[0].metabolic_cost_weight:.4g}",
        *(text(told) if told else "-" for told in (ours, authors) for text in _SHOWN.values()),
    ]


def seeds_table(groups: Sequence[Group], test_set: str = "") -> str:
    """Return the median over seeds, and the least and the greatest seed, of groups of several.

    test_set: the key in a test's results that holds it, "" for our test set.
    """
    header = ["runs", "seeds", "lambda / per W", *_OVER_SEEDS]
    rows = [
        [
            group.name,
            str(len(group.runs)),
            f"{group.common.weight:.4g}",
            *(_over_seeds(group, test_set, *told) for told in _OVER_SEEDS.values()),
        ]
        for group in groups
        if len(group.runs) > 1
    ]
    return report_page.table(header, rows)


# The measures that are told over seeds: their names in results.json, and how they are written.
_OVER_SEEDS: dict[str, tuple[str, Callable[[float | None], str]]] = {
    "median |vergence error| / deg": ("median_abs_vergence_error_deg", number),
    "IQR of |vergence error| / deg": ("iqr_abs_vergence_error_deg", number),
    "median Delta C / W": ("median_delta_cost_w", number),
    "median c": ("median_cost_reduction", percent),
    "within 1 px": ("share_within_1_px", percent),
    "beyond 1 deg": ("share_beyond_1_deg", percent),
    "right muscle silent": ("share_right_muscle_silent", percent),
}


def _over_seeds(group: Group, key: str, measure: str, text: Callable[[float | None], str]) -> str:
    told = group.summaries_at(group.iterations[-1])
    found = [(one.get(key, {}) if key else one).get(measure) for one in told]
    values = [value for value in found if value is not None]
    if len(values) < len(found):
        return "-"
    return f"{text(statistics.median(values))} ({text(min(values))} to {text(max(values))})"


def bias_table(groups: Sequence[Group]) -> str:
    """Return the median signed error of each group's last test by object distance."""
    told = [group.last_summary or {} for group in groups]
    biases_deg = [one.get("bias_by_distance_deg", {}) for one in told]
    distances = sorted({d for bias_deg in biases_deg for d in bias_deg}, key=float)
    rows = [
        (
            group.name,
            f"{group.common.weight:.4g}",
            *(number(bias_deg.get(d)) for d in distances),
        )
        for group, bias_deg in zip(groups, biases_deg, strict=True)
    ]
    header = ("runs", "lambda / per W", *(f"at {d} m, deg" for d in distances))
    return report_page.table(header, rows)


def iterations_table(groups: Sequence[Group]) -> str:
    """Return each group's measures after 1, 2, 3 and all iterations of the last test's trials."""
    header = (
        "runs",
        "lambda / per W",
        "trained for",
        "after",
        "median |vergence error| / deg",
        "IQR / deg",
        "within 1 px",
        "beyond 1 deg",
        "median c",
    )
    rows = []
    for group in groups:
        whole = group.last_summary or {}
        last = group.last_trials.n_iterations if group.has_trials else REPORTED_ITERATIONS[-1]
        early = {k: whole[f"after_{k}"] for k in REPORTED_ITERATIONS if f"after_{k}" in whole}
        for k, told in (early | {last: whole}).items() if whole else ():
            rows.append(
                (
                    group.name,
                    f"{group.common.weight:.4g}",
                    f"{group.iterations[-1]:,}",
                    str(k),
                    number(told["median_abs_vergence_error_deg"]),
                    number(told["iqr_abs_vergence_error_deg"]),
                    percent(told.get("share_within_1_px")),
                    percent(told.get("share_beyond_1_deg")),
                    percent(told["median_cost_reduction"]),
                )
            )
    return report_page.table(header, rows)


def tests_of_run_table(run: ReportedRun) -> str:
    """Return a run's tests, as in its results.json."""
    header = (
        "iteration",
        "trials",
        "median |vergence error| / deg",
        "IQR / deg",
        "within 1 px",
        "beyond 1 deg",
        "median Delta C / W",
        "median c",
        "right muscle silent",
        "authors' test set: median |vergence error| / deg",
        "authors' test set: IQR / deg",
    )
    rows = []
    for told in run.summaries:
        authors = told.get("authors_test_set", {})
        rows.append(
            (
                f"{told['iteration']:,}",
                str(told["n_trials"]),
                number(told["median_abs_vergence_error_deg"]),
                number(told["iqr_abs_vergence_error_deg"]),
                percent(told.get("share_within_1_px")),
                percent(told.get("share_beyond_1_deg")),
                number(told["median_delta_cost_w"]),
                percent(told["median_cost_reduction"]),
                percent(told.get("share_right_muscle_silent")),
                number(authors.get("median_abs_vergence_error_deg")),
                number(authors.get("iqr_abs_vergence_error_deg")),
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
