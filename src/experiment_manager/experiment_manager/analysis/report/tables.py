"""The tables of a report: K17's numbers beside those of the runs."""

import statistics
from collections.abc import Callable, Sequence
from dataclasses import astuple, dataclass, replace

from experiment_manager.analysis.recorded_run import RecordedRun
from experiment_manager.analysis.report import page as report_page
from experiment_manager.analysis.report.groups import Group
from experiment_manager.analysis.report.reported_run import ReportedRun
from experiment_manager.analysis.resting_places import resting_places
from experiment_manager.measures.metrics import REPORTED_ITERATIONS, SHARE_ITERATIONS
from experiment_manager.measures.results import Measures, SetSummary
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


@dataclass(frozen=True)
class _Column:
    """A measure in tables: its heading, where it is found, and how it is written."""

    heading: str
    value: Callable[[Measures], float | None]
    text: Callable[[float | None], str]

    def cell(self, measures: Measures) -> str:
        return self.text(self.value(measures))


_ERROR = _Column("median |vergence error| / deg", lambda m: m.median_abs_vergence_error_deg, number)
_IQR = _Column("IQR of |vergence error| / deg", lambda m: m.iqr_abs_vergence_error_deg, number)
_SHORT_IQR = replace(_IQR, heading="IQR / deg")
_DELTA_COST = _Column("median Delta C / W", lambda m: m.median_delta_cost_w, number)
_REDUCTION = _Column("median c", lambda m: m.median_cost_reduction, percent)
_WITHIN = _Column("within 1 px", lambda m: m.share_within_1_px, percent)
_BEYOND = _Column("beyond 1 deg", lambda m: m.share_beyond_1_deg, percent)
_SILENT = _Column("antagonist silent", lambda m: m.share_antagonist_silent, percent)

_OF_GROUPS = (_ERROR, _IQR, _DELTA_COST, _REDUCTION, _WITHIN, _BEYOND, _SILENT)
_OF_ITERATIONS = (_ERROR, _SHORT_IQR, _WITHIN, _BEYOND, _REDUCTION)
_OF_TESTS = (_ERROR, _SHORT_IQR, _WITHIN, _BEYOND, _DELTA_COST, _REDUCTION, _SILENT)
_OF_TESTS_AUTHORS = (_ERROR, _SHORT_IQR)


def runs_table(groups: Sequence[Group]) -> str:
    """Return one line per run: what it is, lambda and its share of the reward.

    The share is over the first and the last 5,000 iterations, of a shorter run over all.
    """
    header = ["run", "model", "profile", "seed", "iterations", "lambda / per W"]
    header += ["lambda's share at the start", "at the end", "commit"]
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
    """Return the share; of a run with fewer iterations than it is measured over, over how many."""
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
    for trial_set in ("our test set", "authors' test set"):
        measures = ("trials", *(column.heading for column in _OF_GROUPS))
        names += [f"{trial_set}: {measure}" for measure in measures]
    rows = [(name, *cells) for name, *cells in zip(names, *columns, strict=True)]
    return report_page.table(header, rows)


def _paper_column(paper: _Paper) -> list[str]:
    ours = ["-"] * (1 + len(_OF_GROUPS))
    authors = ["-", paper.median_deg, paper.iqr_deg, "-", paper.cost_reduction, "-", "-", "-"]
    return [paper.n_iterations, "5", paper.weight, *ours, *authors]


def _column(group: Group) -> list[str]:
    test = group.last_summary
    cells = [f"{group.iterations[-1]:,}", str(len(group.runs)), _weight(group)]
    for of_set in (test, test and test.authors_test_set):
        if of_set is None:
            cells += ["-"] * (1 + len(_OF_GROUPS))
        else:
            cells += [f"{of_set.n_trials:,}", *(column.cell(of_set) for column in _OF_GROUPS)]
    return cells


def _weight(group: Group) -> str:
    return f"{group.common.weight:.4g}"


def seeds_table(groups: Sequence[Group], *, authors: bool = False) -> str:
    """Return the median over seeds, and the least and the greatest seed, of groups of several.

    authors: of the authors' test set, instead of ours.
    """
    header = ["runs", "seeds", "lambda / per W", *(column.heading for column in _OF_GROUPS)]
    rows = []
    for group in groups:
        if len(group.runs) > 1:
            tests = group.summaries_at(group.iterations[-1])
            sets = [test.authors_test_set if authors else test for test in tests]
            cells = [_over_seeds(sets, column) for column in _OF_GROUPS]
            rows.append([group.name, str(len(group.runs)), _weight(group), *cells])
    return report_page.table(header, rows)


def _over_seeds(sets: Sequence[SetSummary], column: _Column) -> str:
    values = [value for of_seed in sets if (value := column.value(of_seed)) is not None]
    if len(values) < len(sets):
        return "-"
    median, least, greatest = map(
        column.text, (statistics.median(values), min(values), max(values))
    )
    return f"{median} ({least} to {greatest})"


def bias_table(groups: Sequence[Group]) -> str:
    """Return the median signed error of each group's last test by object distance."""
    tests = [group.last_summary for group in groups]
    biases_deg = [test.bias_by_distance_deg if test else {} for test in tests]
    distances_m = sorted(set().union(*biases_deg))
    rows = [
        (group.name, _weight(group), *(number(bias_deg.get(d)) for d in distances_m))
        for group, bias_deg in zip(groups, biases_deg, strict=True)
    ]
    header = ("runs", "lambda / per W", *(f"at {d:g} m, deg" for d in distances_m))
    return report_page.table(header, rows)


def iterations_table(groups: Sequence[Group]) -> str:
    """Return each group's measures after 1, 2, 3 and all iterations of the last test's trials."""
    header = ("runs", "lambda / per W", "trained for", "after")
    rows = []
    for group in groups:
        test = group.last_summary
        if test is not None:
            last = group.last_trials.n_iterations if group.has_trials else REPORTED_ITERATIONS[-1]
            rows += [
                (
                    group.name,
                    _weight(group),
                    f"{group.iterations[-1]:,}",
                    str(k),
                    *(column.cell(measures) for column in _OF_ITERATIONS),
                )
                for k, measures in {**test.after, last: test}.items()
            ]
    return report_page.table((*header, *(column.heading for column in _OF_ITERATIONS)), rows)


def learning_table(run: ReportedRun) -> str:
    """Return a run's tests, as in its results.json."""
    header = ["iteration", "trials", *(column.heading for column in _OF_TESTS)]
    header += [f"authors' test set: {column.heading}" for column in _OF_TESTS_AUTHORS]
    rows = [
        (
            f"{test.iteration:,}",
            str(test.n_trials),
            *(column.cell(test) for column in _OF_TESTS),
            *(column.cell(test.authors_test_set) for column in _OF_TESTS_AUTHORS),
        )
        for test in run.summaries
    ]
    return report_page.table(header, rows)


def resting_table(run: RecordedRun) -> str:
    """Return where the trials of a run's tests come to rest."""
    header = ["iteration", "trials at rest", "bias / deg", "SD / deg"]
    header += ["SD within picture and distance / deg", "SD between them / deg"]
    header += ["SD over time / deg", "share left by an iteration"]
    rows = []
    for test in run.tests:
        n_trials, *values = astuple(resting_places(test.trials))
        cells = map(number, values)
        rows.append((f"{test.trials.training_iteration:,}", str(n_trials), *cells))
    return report_page.table(header, rows)
