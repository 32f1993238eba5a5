"""The tables of a report: K17's numbers beside those of the runs."""

import math
import statistics
from collections.abc import Callable, Iterable, Sequence
from dataclasses import astuple, dataclass, replace
from itertools import chain

import msgspec

from active_binocular_vision.pages.report import page as report_page
from active_binocular_vision.runs.finished_run import FinishedRun
from active_binocular_vision.runs.groups import Group
from active_binocular_vision.runs.recorded import RecordedTest
from active_binocular_vision.runs.resting_places import resting_places
from experiment_manager.measures.metrics import REPORTED_ITERATIONS, SHARE_ITERATIONS
from experiment_manager.measures.results import Measures, SetSummary, Summary
from experiment_manager.measures.tables import number, percent
from experiment_manager.measures.yoked import yoked_pairs


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
_OTHER_AXES = (
    _Column("median |vertical error| / deg", lambda m: m.median_abs_vertical_error_deg, number),
    _Column("IQR of |vertical error| / deg", lambda m: m.iqr_abs_vertical_error_deg, number),
    _Column(
        "median |cyclovergence error| / deg",
        lambda m: m.median_abs_cyclovergence_error_deg,
        number,
    ),
    _Column(
        "IQR of |cyclovergence error| / deg", lambda m: m.iqr_abs_cyclovergence_error_deg, number
    ),
)
_SHORT_IQR = replace(_IQR, heading="IQR / deg")
_DELTA_COST = _Column("median Delta C / W", lambda m: m.median_delta_cost_w, number)
_REDUCTION = _Column("median c", lambda m: m.median_cost_reduction, percent)
_WITHIN = _Column("within 1 px", lambda m: m.share_within_1_px, percent)
_BEYOND = _Column("beyond 1 deg", lambda m: m.share_beyond_1_deg, percent)
_SILENT = _Column("antagonist silent", lambda m: m.share_antagonist_silent, percent)

# Each begins with the vergence error and its spread.
_OF_GROUPS = (_ERROR, _IQR, _DELTA_COST, _REDUCTION, _WITHIN, _BEYOND, _SILENT)
_OF_ITERATIONS = (_ERROR, _SHORT_IQR, _WITHIN, _BEYOND, _REDUCTION)
_OF_TESTS = (_ERROR, _SHORT_IQR, _WITHIN, _BEYOND, _DELTA_COST, _REDUCTION, _SILENT)
_OF_TESTS_AUTHORS = (_ERROR, _SHORT_IQR)


def _with_other_axes(
    columns: tuple[_Column, ...], tests: Iterable[Measures | None]
) -> tuple[_Column, ...]:
    """Return the columns, with those of vertical error and cyclovergence where a test has them."""
    known = [test for test in tests if test is not None]
    others = [column for column in _OTHER_AXES if any(column.value(t) is not None for t in known)]
    return (*columns[:2], *others, *columns[2:])


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
            *(
                _share_of_reward(share, run.n_iterations)
                for share in msgspec.structs.astuple(run.results.cost_shares)
            ),
            run.commit[:12] or "unknown",
        )
        for group in groups
        for run in group.runs
    ]
    return report_page.table(header, rows)


def _share_of_reward(share: float | None, n_iterations: int) -> str:
    """Return the share as text; of a run shorter than the window, also over how many iterations."""
    whole = n_iterations >= SHARE_ITERATIONS or share is None
    return percent(share) if whole else f"{percent(share)} (all {n_iterations:,})"


def comparison_table(groups: Sequence[Group]) -> str:
    """Return the paper's measures beside those of each group's last test, trials pooled."""
    header = ["measure"]
    columns: list[list[str]] = []
    tests = [group.last_summary for group in groups]
    measures = _with_other_axes(_OF_GROUPS, tests)
    for group, test in zip(groups, tests, strict=True):
        if group.is_of_pair and group.model in _PAPER and f"paper, {group.model}" not in header:
            header.append(f"paper, {group.model}")
            columns.append(_paper_column(_PAPER[group.model], measures))
        header.append(f"ours, {group.name}")
        columns.append(_column(group, test, measures))
    names = ["training iterations", "runs pooled", "lambda / per W"]
    trial_sets = ["our test set"]
    if any(group.is_of_pair for group in groups):
        trial_sets.append("authors' test set")
    for trial_set in trial_sets:
        names += [f"{trial_set}: {name}" for name in ("trials", *(m.heading for m in measures))]
    # The authors' test set comes last in the columns; it may have no rows.
    rows = [(name, *cells) for name, *cells in zip(names, *columns, strict=False)]
    return report_page.table(header, rows)


def _paper_column(paper: _Paper, measures: Sequence[_Column]) -> list[str]:
    ours = ["-"] * (1 + len(measures))
    known = {_ERROR: paper.median_deg, _IQR: paper.iqr_deg, _REDUCTION: paper.cost_reduction}
    authors = ["-", *(known.get(measure, "-") for measure in measures)]
    return [paper.n_iterations, "5", paper.weight, *ours, *authors]


def _column(group: Group, test: Summary | None, measures: Sequence[_Column]) -> list[str]:
    """Return the measures of both test sets; the authors' is one of the pair alone."""
    authors = test.authors_test_set if test and group.is_of_pair else None
    cells = [f"{group.iterations[-1]:,}", str(len(group.runs)), _weight(group)]
    for of_set in (test, authors):
        if of_set is None:
            cells += ["-"] * (1 + len(measures))
        else:
            cells += [f"{of_set.n_trials:,}", *(measure.cell(of_set) for measure in measures)]
    return cells


def _weight(group: Group) -> str:
    return f"{group.common.weight:.4g}"


def seeds_table(groups: Sequence[Group], *, authors: bool = False) -> str:
    """Return the median over seeds, and the least and the greatest seed, of groups of several.

    authors: of the authors' test set, which groups of the pair have, instead of ours.
    """
    chosen = [g for g in groups if len(g.runs) > 1 and (g.is_of_pair or not authors)]
    tests = [group.summaries_at(group.iterations[-1]) for group in chosen]
    columns = _with_other_axes(_OF_GROUPS, chain(*tests))
    header = ["runs", "seeds", "lambda / per W", *(column.heading for column in columns)]
    rows = []
    for group, of_group in zip(chosen, tests, strict=True):
        sets = [test.authors_test_set if authors else test for test in of_group]
        cells = [_over_seeds(sets, column) for column in columns]
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
    distances_m = sorted(set().union(*biases_deg), key=float)
    rows = [
        (group.name, _weight(group), *(number(bias_deg.get(d)) for d in distances_m))
        for group, bias_deg in zip(groups, biases_deg, strict=True)
    ]
    header = ("runs", "lambda / per W", *(f"at {d} m, deg" for d in distances_m))
    return report_page.table(header, rows)


def antagonists_table(groups: Sequence[Group]) -> str:
    """Return how antagonists share their work after each group's last test, a line a pair."""
    rows = []
    distances_m: set[str] = set()
    for group in groups:
        test = group.last_summary
        for names, pair in (test.antagonists if test else {}).items():
            distances_m |= pair.share_silent_by_distance.keys()
            rows.append((group, names, pair))
    header = ["runs", "lambda / per W", "eye", "antagonists", "co-contraction", "one is silent"]
    in_order = sorted(distances_m, key=float)
    lines = [
        (
            group.name,
            _weight(group),
            *_eye_and_muscles(names),
            number(pair.median_co_contraction),
            percent(pair.share_silent),
            *(percent(pair.share_silent_by_distance.get(d)) for d in in_order),
        )
        for group, names, pair in rows
    ]
    return report_page.table((*header, *(f"at {d} m" for d in in_order)), lines)


def _eye_and_muscles(names: str) -> tuple[str, str]:
    """Return the eye of two antagonists, and what they are, from their names in results.json."""
    muscles = [name.partition("_") for name in names.split("-")]
    return muscles[0][0], " and ".join(muscle.replace("_", " ") for _, _, muscle in muscles)


def fixations_table(groups: Sequence[Group]) -> str:
    """Return what saccades reach in each run's last test, and vergence after them."""
    header = ["runs", "seed", "missed after one saccade, deg", "after two", "gaze moves, deg"]
    header += ["horizontal error, deg", "vertical", "cyclovergence", "within 1 px"]
    rows = []
    for group in groups:
        for run in group.runs:
            test = run.summaries[-1]
            if test.fixation_spreads:
                cells = (f"{number(s.median)} / {number(s.p90)}" for s in test.fixation_spreads)
                share = percent(test.share_fixated_within_1_px)
                rows.append((group.name, str(run.seed), *cells, share))
    return report_page.table(header, rows)


def yoked_table(groups: Sequence[Group]) -> str:
    """Return how alike yoked muscles are in each group's last test, a line for each two."""
    header = ("runs", "lambda / per W", "yoked muscles", "difference at the start", "at the end")
    rows = [
        (
            group.name,
            _weight(group),
            " and ".join(name.replace("_", " ") for name in pair.names),
            number(pair.start_difference),
            number(pair.end_difference),
            "-" if math.isnan(pair.correlation) else number(pair.correlation, 2),
        )
        for group in groups
        if group.has_trials
        for pair in yoked_pairs([run.trials[group.iterations[-1]] for run in group.runs])
    ]
    return report_page.table((*header, "correlation at the end"), rows)


def iterations_table(groups: Sequence[Group]) -> str:
    """Return each group's measures after 1, 2, 3 and all iterations of the last test's trials."""
    header = ("runs", "lambda / per W", "trained for", "after")
    rows = []
    tests = [group.last_summary for group in groups]
    columns = _with_other_axes(_OF_ITERATIONS, tests)
    for group, test in zip(groups, tests, strict=True):
        if test is not None:
            last = group.last_trials.n_iterations if group.has_trials else REPORTED_ITERATIONS[-1]
            rows += [
                (
                    group.name,
                    _weight(group),
                    f"{group.iterations[-1]:,}",
                    str(k),
                    *(column.cell(measures) for column in columns),
                )
                for k, measures in {**test.after, last: test}.items()
            ]
    return report_page.table((*header, *(column.heading for column in columns)), rows)


def learning_table(run: FinishedRun) -> str:
    """Return a run's tests, as in its results.json."""
    columns = _with_other_axes(_OF_TESTS, run.summaries)
    of_authors = _OF_TESTS_AUTHORS if run.is_of_pair else ()
    header = ["iteration", "trials", *(column.heading for column in columns)]
    header += [f"authors' test set: {column.heading}" for column in of_authors]
    rows = [
        (
            f"{test.iteration:,}",
            str(test.n_trials),
            *(column.cell(test) for column in columns),
            *(column.cell(test.authors_test_set) for column in of_authors),
        )
        for test in run.summaries
    ]
    return report_page.table(header, rows)


def resting_table(tests: Sequence[RecordedTest]) -> str:
    """Return where the trials of a run's tests end."""
    header = ["iteration", "trials counted", "bias / deg", "SD / deg"]
    header += ["SD within picture and distance / deg", "SD between them / deg"]
    header += ["SD over time / deg", "share left after an iteration"]
    rows = []
    for test in tests:
        n_trials, *values = astuple(resting_places(test.trials))
        cells = map(number, values)
        rows.append((f"{test.trials.training_iteration:,}", str(n_trials), *cells))
    return report_page.table(header, rows)
