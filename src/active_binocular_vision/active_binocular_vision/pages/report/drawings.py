"""The figures of a report, with their captions, and what they need that a run may not have."""

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from matplotlib.figure import Figure

from active_binocular_vision.figures.runs.activations import activations_figure
from active_binocular_vision.figures.runs.boxes import box_figure
from active_binocular_vision.figures.runs.conditions import conditions_figure
from active_binocular_vision.figures.runs.dictionaries import dictionary_figure
from active_binocular_vision.figures.runs.errors import errors_figure
from active_binocular_vision.figures.runs.learning_curve import performance_figure
from active_binocular_vision.figures.runs.motor_space import motor_space, motor_space_figure
from active_binocular_vision.figures.runs.pictures import anaglyph_figure, encoding_figure
from active_binocular_vision.figures.runs.price import over_prices, price_figure
from active_binocular_vision.runs.finished_run import FinishedRun
from active_binocular_vision.runs.groups import Group
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from lockstep import read_state

# More than these cannot be told apart in one plane of activations; they are chosen evenly.
_MOST_GROUPS = 4
_NEEDS_TRIALS = "trials.npz or a bag"
_NEEDS_PAIR = "a plane of two activations, those of both eyes alike"


@dataclass(frozen=True)
class Drawing:
    """A figure of a report.

    draw: returns None when nothing of what it needs is there; absence: stands in its place then;
    left_out: the runs that it does not show and what they lack, stands below it otherwise.
    """

    name: str
    title: str
    caption: str
    draw: Callable[[], Figure | None]
    absence: str = ""
    left_out: str = ""


def drawings(groups: Sequence[Group]) -> Iterator[Drawing]:
    """Yield all figures of a report in their order."""
    with_trials = [group for group in groups if group.has_trials]
    without_trials = [group for group in groups if not group.has_trials]
    yield Drawing(
        "performance",
        "Test performance over training (K17 Fig. 2)",
        "(a) Absolute vergence error and (b) metabolic rate above the least one that fixates the "
        "object, after the last iteration of test trials. Thick lines or points: median over all "
        "trials of all seeds. Bands or bars: quartiles over the trials, not the uncertainty of the "
        "median. Thin lines: medians of single seeds. Fewer than five tests are not joined.",
        lambda: performance_figure(groups),
        left_out=_left_out(f"Without quartiles, which need {_NEEDS_TRIALS}", without_trials),
    )
    left_out = _left_out(f"Not drawn without {_NEEDS_TRIALS}", without_trials)
    yield Drawing(
        "boxes",
        "Test performance at the end of training (K17 Fig. 3)",
        "(a) Absolute vergence error and (b) c, the share of the possible saving that a trial "
        "makes (K17 eq. 8), after iterations 1, 2, 3 and 20 of the trials. Lines are medians, "
        "boxes quartiles, whiskers the 5th and 95th percentiles over all trials of all seeds. c is "
        "not defined for trials that start within 10 mW of the least cost.",
        lambda: box_figure(with_trials) if with_trials else None,
        left_out,
        left_out,
    )
    yield from _motor_spaces(groups, left_out)
    yield from _of_own_commands(with_trials)
    yield Drawing(
        "conditions",
        "Errors by distance and starting error",
        "Median absolute vergence error in deg after the last iteration of the last test's trials, "
        "by object distance and by the vergence error at the start of the trial. White is 1 px, "
        "blue less, red more. Hatched: no trials."
        + ("" if all(g.is_of_pair for g in groups) else " Starts are rounded to whole degrees."),
        lambda: conditions_figure(with_trials) if with_trials else None,
        left_out,
        left_out,
    )
    yield from _prices(groups)
    yield from _drawings_from_bags(groups)


def _motor_spaces(all_groups: Sequence[Group], without_trials: str) -> Iterator[Drawing]:
    """Yield a plane of activations for each plant; without_trials: the runs left out for that."""
    title = "Muscles and their cost (K17 Fig. 4)"
    not_of_pair = _left_out(
        f"Not drawn without {_NEEDS_PAIR}", (g for g in all_groups if not g.is_of_pair)
    )
    left_out = " ".join(filter(None, (without_trials, not_of_pair)))
    groups = [group for group in all_groups if group.has_trials and group.is_of_pair]
    if not groups:
        yield Drawing("motor_space", title, "", lambda: None, left_out)
    by_plant: dict[MechanicsConfig, list[Group]] = defaultdict(list)
    for group in groups:
        by_plant[group.last_mechanics].append(group)
    for number, (mechanics, members) in enumerate(by_plant.items()):
        yield Drawing(
            f"motor_space_{number}" if number else "motor_space",
            title,
            "Activations of both eyes' horizontal recti during trials with (a) the nearest and (b) "
            "the farthest object. Lines with dots: iterations of the last test's trials, of all "
            "seeds, with the first test picture, that start with errors of -3, -1, 1 and 3 deg "
            "where the distance allows. Circles (M) and diamonds (M_C): their ends. Grey contours: "
            "metabolic rate of both eyes. Black: activations that fixate the object; dashed: 1 px "
            "off. The cost of a muscle is constant below the dotted activation of 0.005. At most "
            "four settings are shown.",
            partial(_motor_space, mechanics, members),
            left_out=left_out,
        )


def _of_own_commands(groups: Sequence[Group]) -> Iterator[Drawing]:
    """Yield what shows the groups, with trials, whose commands are not those of the pair."""
    chosen = [group for group in groups if not group.is_of_pair]
    if chosen:
        yield Drawing(
            "errors",
            "Errors about all axes",
            "(a to c) Over the iterations of the last test's trials that were kept. (d to f) After "
            "the last iteration of test trials, over training. Medians of the absolute error; bars "
            "or bands are quartiles over all trials of all seeds. Fewer than five tests are not "
            "joined. Horizontal and vertical: disparity of the point that the left fovea looks at. "
            "Torsional: rotation of one eye's picture around that point against the other's.",
            partial(errors_figure, chosen),
        )
    for number, group in enumerate(chosen):
        yield Drawing(
            f"activations_{number}_{group.model}",
            f"Muscles of {group.name}",
            "Activations at the start (rings) and at the end (dots) of the last test's trials, by "
            "object distance. Points are medians, bars quartiles over all trials of all seeds. A "
            "panel shows two antagonists.",
            partial(activations_figure, group),
        )


def _prices(groups: Sequence[Group]) -> Iterator[Drawing]:
    family = over_prices(groups)
    if family:
        yield Drawing(
            "price_of_energy",
            "The price of energy",
            "After the last iteration of the last test's trials: (a) absolute error and "
            "(b) c, the share of the possible saving, over lambda, and (c) median error against "
            "median metabolic rate, a point per lambda, with its lambda. Points are medians "
            "over all trials of all seeds; bars are quartiles over the trials, not the uncertainty "
            "of the median. Model M is lambda 0 where there is no M_C with lambda 0.",
            lambda: price_figure(family),
        )


def _drawings_from_bags(groups: Sequence[Group]) -> Iterator[Drawing]:
    recorded = [group for group in groups if group.recorded_iterations]
    left_out = _left_out(
        "Not drawn without a test in a bag", (g for g in groups if not g.recorded_iterations)
    )
    yield Drawing(
        "encoding",
        "Reconstruction error, from which the reward follows",
        "Reconstruction error against vergence error in the first and the last test of the bags: "
        "medians, and quartiles as bands, over all iterations of all trials, in bins of 0.25 deg. "
        "Dotted: 1 px.",
        lambda: encoding_figure(recorded) if recorded else None,
        left_out or "Too few observations in any bin.",
        left_out,
    )
    for number, group in enumerate(groups):
        yield from _drawings_of_run(group.runs[0], f"{number}_{group.model}")


def _left_out(what: str, groups: Iterable[Group]) -> str:
    names = [run.name for group in groups for run in group.runs]
    return f"{what}: {', '.join(names)}." if names else ""


def _drawings_of_run(run: FinishedRun, mark: str) -> Iterator[Drawing]:
    yield Drawing(
        f"dictionaries_{mark}",
        f"Basis functions of {run.name}",
        "(a, b) Each tile is a basis function, left eye's half on the left, right eye's on the "
        "right, scaled by its largest entry. The order is by preferred disparity, row by row; the "
        "others follow, from the most binocular to the most monocular. (c, d) Number of basis "
        "functions by preferred disparity, on a logarithmic axis. The disparity follows from the "
        "phases of one Gabor function fitted to both halves, where it leaves at most 20 % of their "
        "energy; it is positive when the pattern lies farther right in the left eye.",
        lambda: _dictionaries(run),
        f"{run.name} has no checkpoint to take basis functions from.",
    )
    yield Drawing(
        f"anaglyphs_{mark}",
        f"What the eyes of {run.name} see",
        "One trial in the bag's first test (a, b) and last test (c, d), at its start and at its "
        "end: left eye in red, right eye in cyan. Coloured fringes are disparity. The frame is the "
        "window of the coarse scale. Of the trials with pictures, this one ends with the median "
        "error.",
        lambda: anaglyph_figure(run),
        "Not drawn without a bag with pictures of a trial common to its first and last test.",
    )


def _dictionaries(run: FinishedRun) -> Figure | None:
    if run.states is None:
        return None
    return dictionary_figure(read_state(run.states / "sparse_coder.npz", "sparse_coder")["atoms"])


def _motor_space(mechanics: MechanicsConfig, groups: Sequence[Group]) -> Figure:
    chosen = sorted({round(i) for i in np.linspace(0, len(groups) - 1, _MOST_GROUPS)})
    return motor_space_figure(motor_space(mechanics), [groups[i] for i in chosen])
