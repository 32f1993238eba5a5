"""The tables of a report, as rows of texts by heading: K17's numbers beside those of the runs."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import astuple
from functools import partial
from typing import Any

import msgspec
import numpy as np

from active_binocular_vision.runs.groups import Group
from active_binocular_vision.runs.held_gaze import held_cost_ratios
from active_binocular_vision.runs.recorded import RecordedTest
from active_binocular_vision.runs.resting_places import resting_places
from active_binocular_vision.runs.run import Run
from experiment_manager.measures.metrics import REPORTED_ITERATIONS, SHARE_ITERATIONS
from experiment_manager.measures.results import Measures, Summary
from experiment_manager.measures.seeds import over_seeds
from experiment_manager.measures.tables import active_text, number, percent
from experiment_manager.measures.yoked import yoked_pairs
from lockstep import ALL_MUSCLES, SIDES

Row = dict[str, str]

_OURS, _UP_TO_2_DEG = "our test set: ", "starts up to 2 deg: "
_ERROR, _IQR = "median |vergence error| / deg", "IQR of |vergence error| / deg"
_REDUCTION = "median c"
# Only tests with commands of their own for the muscles have these.
_OTHER_AXES = {
    f"{name} |{axis} error| / deg": (f"{part}_abs_{axis}_error_deg", number)
    for axis in ("vertical", "cyclovergence")
    for name, part in (("median", "median"), ("IQR of", "iqr"))
}
# By heading: the measure, with a dot before a part of it, and how it is written.
_MEASURES: Mapping[str, tuple[str, Callable[..., str]]] = {
    _ERROR: ("median_abs_vergence_error_deg", number),
    _IQR: ("iqr_abs_vergence_error_deg", number),
    **_OTHER_AXES,
    "median Delta C / W": ("median_delta_cost_w", number),
    "median C / C*": ("median_cost_ratio", partial(number, n_digits=2)),
    _REDUCTION: ("saving", percent),
    "within 1 px": ("share_within_1_px", percent),
    "beyond 1 deg": ("share_beyond_1_deg", percent),
    "both antagonists active": ("antagonists_active.both", percent),
    "one active": ("antagonists_active.one", percent),
    "none active": ("antagonists_active.none", percent),
    "active muscles, median": ("median_active_muscles", partial(number, n_digits=1)),
    "antagonist silent": ("share_antagonist_silent", percent),
}
# What tests of one kind of eyes only have, or not those of older runs.
_OPTIONAL = {*_OTHER_AXES, *list(_MEASURES)[-5:], "median C / C*"}
# What K17 III states of a model; figures only give the rest.
_PAPER: Mapping[str, Row] = {
    model: {
        "training iterations": "1,000,000",
        "runs pooled": "5",
        "lambda / per W": weight,
        _UP_TO_2_DEG + _ERROR: median_deg,
        _UP_TO_2_DEG + _IQR: iqr_deg,
        _UP_TO_2_DEG + _REDUCTION: reduction,
    }
    for model, weight, median_deg, iqr_deg, reduction in (
        ("M", "0", "0.07", "0.080", "single digits"),
        ("M_C", "0.035", "0.176", "0.269", "101.7 %"),
    )
}

# Rhesus monkeys looking at far targets: rates over eye position of a motoneuron of each muscle.
_PUBLISHED_SLOPES = (
    {
        "runs": "monkey: Miller, Davison & Gamlin 2011, Figs. 4 and 6",
        "antagonists": "medial rectus (5.4 spikes/s per deg) and lateral rectus (6.2)",
        "slope of lesser over greater": "-0.87, -1.15",
    },
)


def _measured(sets: Sequence[Measures], before: str = "") -> Row:
    """Return the measures of a set of trials; of several seeds' sets as `_over_seeds_text` does.

    before: in front of each heading.
    """
    row = {}
    for heading, (path, text) in _MEASURES.items():
        values = [value for of_set in sets if (value := _value(of_set, path)) is not None]
        if values or heading not in _OPTIONAL:
            is_known = len(values) == len(sets)
            row[before + heading] = _over_seeds_text(values, text) if is_known else "-"
    return row


def _value(measures: Any, path: str) -> float | None:
    """Return a measure or a part of it; None where it is not known."""
    for name in path.split("."):
        measures = getattr(measures, name, None)
    return measures


def _over_seeds_text(values: Sequence[float], text: Callable[[float | None], str]) -> str:
    """Return a seed's value, or of several the mean, half its 95 % interval, and the range."""
    if len(values) == 1:
        return text(values[0])
    return f"{_mean_text(values, text)} ({text(min(values))} to {text(max(values))})"


def _mean_text(values: Sequence[float], text: Callable[[float | None], str] = number) -> str:
    """Return a seed's value, or of several the mean with half its 95 % interval."""
    if len(values) == 1:
        return text(values[0])
    mean, half_width = over_seeds(values)
    return f"{text(float(mean))} ± {text(float(half_width))}"


def run_rows(groups: Sequence[Group]) -> list[Row]:
    """Return a row for each run: what it is, lambda and its share of the reward.

    The share is over the first and the last 5,000 iterations, of a shorter run over all.
    """
    rows = []
    for run in (run for group in groups for run in group.runs):
        shares = msgspec.structs.astuple(run.document.cost_shares)
        start, end = (_share_of_reward(share, run.n_iterations) for share in shares)
        rows.append(
            {
                "run": run.name,
                "model": run.model,
                "profile": run.profile or "-",
                "seed": str(run.seed),
                "iterations": f"{run.n_iterations:,}",
                "lambda / per W": f"{run.metabolic_cost_weight:.4g}",
                "lambda's share at the start": start,
                "at the end": end,
                "commit": run.commit[:12] or "unknown",
            }
        )
    return rows


def _share_of_reward(share: float | None, n_iterations: int) -> str:
    """Return the share as text; of a run shorter than the window, also over how many iterations."""
    whole = n_iterations >= SHARE_ITERATIONS or share is None
    return percent(share) if whole else f"{percent(share)} (all {n_iterations:,})"


def comparison_rows(groups: Sequence[Group]) -> list[Row]:
    """Return a row for each measure: the paper's, and those of groups' last tests, pooled."""
    columns: dict[str, Row] = {}
    for group in groups:
        if group.is_of_pair and group.model in _PAPER:
            columns[f"paper, {group.model}"] = _PAPER[group.model]
        column = columns[f"ours, {group.name}"] = {
            "training iterations": f"{group.iterations[-1]:,}",
            "runs pooled": str(len(group.runs)),
            "lambda / per W": f"{group.common.weight:.4g}",
        }
        if test := group.last_summary:
            # Start errors of whole degrees are those of the pair alone.
            near = {_UP_TO_2_DEG: test.starts_up_to_2_deg} if group.is_of_pair else {}
            sets = {_OURS: test} | near
            for name, of_set in sets.items():
                column |= {f"{name}trials": f"{of_set.n_trials:,}", **_measured([of_set], name)}
    names = [s + name for s in (_OURS, _UP_TO_2_DEG) for name in ("trials", *_MEASURES)]
    shown = {name for column in columns.values() for name in column}
    return [
        {"measure": name} | {head: column.get(name, "-") for head, column in columns.items()}
        for name in ("training iterations", "runs pooled", "lambda / per W", *names)
        if name in shown
    ]


def seed_rows(groups: Sequence[Group], *, up_to_2_deg: bool = False) -> list[Row]:
    """Return the mean over seeds with its interval, and the range, of groups of several seeds.

    up_to_2_deg: of the trials of the pair that start so, instead of all.
    """
    rows = []
    for group in groups:
        if len(group.runs) > 1 and (group.is_of_pair or not up_to_2_deg):
            tests = group.summaries_at(group.iterations[-1])
            sets = [test.starts_up_to_2_deg if up_to_2_deg else test for test in tests]
            rows.append({"runs": group.name, "seeds": str(len(sets)), **_measured(sets)})
    return rows


def bias_rows(groups: Sequence[Group]) -> list[Row]:
    """Return the median signed error of each group's last test by object distance."""
    tests = [group.last_summary for group in groups]
    biases_deg = [test.bias_by_distance_deg if test else {} for test in tests]
    distances_m = sorted(set().union(*biases_deg), key=float)
    return [
        {"runs": group.name} | {f"at {d} m, deg": number(bias_deg.get(d)) for d in distances_m}
        for group, bias_deg in zip(groups, biases_deg, strict=True)
    ]


def antagonist_rows(groups: Sequence[Group]) -> list[Row]:
    """Return how antagonists share their work after each group's last test, a row a pair."""
    rows = []
    for group in groups:
        test = group.last_summary
        for names, pair in (test.antagonists if test else {}).items():
            eyes, muscles = zip(*(_eye_and_muscle(n) for n in names.split("-")), strict=True)
            row = {
                "runs": group.name,
                "eye": eyes[0],
                "antagonists": _in_words(muscles),
                "both / one / none active": active_text(pair.active),
                "lesser activation": number(pair.median_co_contraction),
                "slope of lesser over greater": number(pair.reciprocity_slope, 2),
            }
            in_order = sorted(pair.active_by_distance, key=float)
            of_distances = {f"at {d} m": active_text(pair.active_by_distance[d]) for d in in_order}
            rows.append(row | of_distances)
    if rows:
        rows += [dict.fromkeys(rows[0], "-") | published for published in _PUBLISHED_SLOPES]
    return rows


def _eye_and_muscle(name: str) -> tuple[str, str]:
    """Return eye and muscle of a command; a command of the pair is of both eyes."""
    eye, _, muscle = name.partition("_")
    return (eye, muscle) if eye in SIDES else ("both", name)


def _in_words(names: Sequence[str]) -> str:
    return " and ".join(name.replace("_", " ") for name in names)


def held_rows(groups: Sequence[Group]) -> list[Row]:
    """Return what eyes without gaze targets spend over the least at the gaze that they have."""
    rows = []
    for group in groups:
        settings = group.runs[0].evaluation_settings
        if group.has_trials and settings.plant.command_space == ALL_MUSCLES:
            at = group.iterations[-1]
            plant = settings.tested_plant(at)
            if not settings.fixation_iterations:
                ratios = [held_cost_ratios(run.tests[at], plant) for run in group.runs]
                held = [float(np.median(of_run)) for of_run in ratios if of_run.size]
                free = [float(np.nanmedian(run.tests[at].cost_ratio(-1))) for run in group.runs]
                texts = [
                    _over_seeds_text(v, partial(number, n_digits=2)) if v else "-"
                    for v in (held, free)
                ]
                cells = ("C / C* of the gaze that the eyes have", "of free version")
                rows.append({"runs": group.name, **dict(zip(cells, texts, strict=True))})
    return rows


def yoked_rows(groups: Sequence[Group]) -> list[Row]:
    """Return how alike yoked muscles are in each group's last test, a row for each two."""
    return [
        {
            "runs": group.name,
            "yoked muscles": _in_words(pair.names),
            "difference at the start": number(pair.start_difference),
            "at the end": number(pair.end_difference),
            "correlation at the end": "-"
            if math.isnan(pair.correlation)
            else number(pair.correlation, 2),
        }
        for group in groups
        if group.has_trials and not group.is_of_pair
        for pair in yoked_pairs([run.tests[group.iterations[-1]] for run in group.runs])
    ]


def fixation_rows(groups: Sequence[Group]) -> list[Row]:
    """Return what saccades reach in each run's last test, vergence after them, and over seeds."""
    rows = []
    for group in groups:
        tests = {run.seed: run.summaries[-1] for run in group.runs}
        tests = {seed: test for seed, test in tests.items() if test.fixation_spreads}
        for seed, test in tests.items():
            cells = [f"{number(s.median)} / {number(s.p90)}" for s in test.fixation_spreads]
            rows.append(_fixation_row(group, str(seed), cells, [test]))
        if len(tests) > 1:
            of_seeds = zip(*(test.fixation_spreads for test in tests.values()), strict=True)
            cells = [_mean_text([s.median for s in spreads]) for spreads in of_seeds]
            rows.append(_fixation_row(group, "all, medians", cells, [*tests.values()]))
    return rows


def _fixation_row(group: Group, seed: str, cells: Sequence[str], tests: Sequence[Summary]) -> Row:
    names = [
        *("missed after one saccade, deg", "after two", "gaze moves, deg"),
        *("horizontal error, deg", "vertical", "cyclovergence"),
    ]
    row = {"runs": group.name, "seed": seed} | dict(zip(names, cells, strict=True))
    shares = [share for test in tests if (share := test.share_fixated_within_1_px) is not None]
    return row | {"within 1 px": _mean_text(shares, percent) if shares else "-"}


def iteration_rows(groups: Sequence[Group]) -> list[Row]:
    """Return each group's measures after 1, 2, 3 and all iterations of the last test's trials."""
    rows = []
    for group in groups:
        if test := group.last_summary:
            last = group.last_trials.n_iterations if group.has_trials else REPORTED_ITERATIONS[-1]
            about = {"runs": group.name, "trained for": f"{group.iterations[-1]:,}"}
            rows += [
                {**about, "after": str(k), **_measured([measures])}
                for k, measures in {**test.after, last: test}.items()
            ]
    return rows


def learning_rows(run: Run) -> list[Row]:
    """Return a run's tests, as in its results.json."""
    rows = []
    for test in run.summaries:
        row = {"iteration": f"{test.iteration:,}", "trials": str(test.n_trials)}
        near = _measured([test.starts_up_to_2_deg], _UP_TO_2_DEG) if run.is_of_pair else {}
        names = (_UP_TO_2_DEG + _ERROR, _UP_TO_2_DEG + _IQR)
        of_both = {name: near[name] for name in names if near}
        rows.append(row | _measured([test]) | of_both)
    return rows


def resting_rows(tests: Sequence[RecordedTest]) -> list[Row]:
    """Return where the trials of a run's tests end."""
    names = [
        *("bias / deg", "SD / deg", "SD within stimulus and distance / deg"),
        *("SD between them / deg", "SD over time / deg", "share left after an iteration"),
    ]
    rows = []
    for test in tests:
        n_trials, *values = astuple(resting_places(test.trials))
        row = {"iteration": f"{test.trials.training_iteration:,}", "trials counted": str(n_trials)}
        rows.append(row | dict(zip(names, map(number, values), strict=True)))
    return rows
