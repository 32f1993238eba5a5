"""The figures of a report, with their captions, and what they need that a run may not have."""

from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
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
from active_binocular_vision.figures.runs.over_lambda import lambda_figure, over_lambda
from active_binocular_vision.figures.runs.pictures import anaglyph_figure, encoding_figure
from active_binocular_vision.pages.html import Drawing
from active_binocular_vision.runs.groups import Group
from active_binocular_vision.runs.run import Run
from experiment_manager.sections import config_of
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from lockstep import read_state
from sparse_coder import SparseCoderConfig

# More than these cannot be told apart in one plane of activations; they are chosen evenly.
_MOST_GROUPS = 4
_TRIALS = "trials.npz or a bag"
_PAIR = "a plane of two activations, those of both eyes alike"
_PERFORMANCE = (
    "(a) Absolute vergence error and (b) metabolic rate above the least one that fixates the "
    "object, after the last iteration of test trials. Thick lines or points: median over all "
    "trials of all seeds. Bands or bars: quartiles over the trials, not the uncertainty of the "
    "median. Thin lines: medians of single seeds. Fewer than five tests are not joined. Dashes and "
    "dots: the median that K17 reports after 1,000,000 iterations on photographs."
)
_BOXES = (
    "(a) Absolute vergence error and (b) c, the fraction of the avoidable rate that a trial "
    "removes (K17 eq. 8), after iterations 1, 2, 3 and 20 of the trials. Lines are medians, boxes "
    "quartiles, whiskers the 5th and 95th percentiles over all trials of all seeds. c is not "
    "defined for trials that start within 10 mW of the least cost. Dashes and dots: K17's medians."
)
_MOTOR_SPACE = (
    "Activations of both eyes' horizontal recti during trials with (a) the nearest and (b) the "
    "farthest object. Lines with dots: iterations of the last test's trials, of all seeds, with "
    "the first test stimulus, that start with errors of -3, -1, 1 and 3 deg where the distance "
    "allows. Circles (M) and diamonds (M_C): their ends. Grey contours: metabolic rate of both "
    "eyes. Black: activations that fixate the object; dashed: 1 px off. The cost of a muscle is "
    "constant below the dotted activation of 0.005. At most four settings are shown."
)
_ERRORS = (
    "(a to c) Over the iterations of the last test's trials that were kept. (d to f) After the "
    "last iteration of test trials, over training. Medians of the absolute error; bars or bands "
    "are quartiles over all trials of all seeds. The axis is broken where iterations were not "
    "kept. Fewer than five tests are not joined. Horizontal "
    "and vertical: disparity of the point that the left fovea looks at. Torsional: rotation of one "
    "eye's image around that point against the other's."
)
_ACTIVATIONS = (
    "Median activation of each muscle (a) at the start and (b) at the end of the last test's "
    "trials, over all trials of all seeds, by object distance, on a logarithmic scale. (c) Share "
    "of these trials that end with the muscle active: a median of 0 hides muscles that some use."
)
_CONDITIONS = (
    "Median absolute vergence error in deg after the last iteration of the last test's trials, by "
    "object distance and by the vergence error at the start of the trial, in whole degrees. White "
    "is 1 px, blue less, red more. Hatched: no trials."
)
_LAMBDA = (
    "After the last iteration of the last test's trials: (a) absolute error and (b) c, the share "
    "of the possible saving, over lambda, and (c) median error against median metabolic rate, a "
    "point per lambda, with its lambda. Points are medians over all trials of all seeds; bars are "
    "quartiles over the trials, not the uncertainty of the median. Model M is lambda 0 where there "
    "is no M_C with lambda 0."
)
_ENCODING = (
    "Reconstruction error against vergence error in the first and the last test of the bags: "
    "medians, and quartiles as bands, over all iterations of all trials, in bins of 0.25 deg. "
    "Dotted: 1 px."
)
_DICTIONARIES = (
    "(a, b) Each tile is a basis function, left eye's half on the left, right eye's on the right, "
    "scaled by its largest entry. The order is by preferred disparity, row by row; the others "
    "follow, from the most binocular to the most monocular. (c, d) Number of basis functions by "
    "preferred disparity, on a logarithmic axis. The disparity follows from the phases of one "
    "Gabor function fitted to both halves, where it leaves at most 20 % of their energy; it is "
    "positive when the pattern lies farther right in the left eye."
)
_ANAGLYPHS = (
    "One trial in the bag's first test (a, b) and last test (c, d), at its start and at its end: "
    "left eye in red, right eye in cyan. Coloured fringes are disparity. The frame is the window "
    "of the coarse scale. Of the trials with images, this one ends with the median error."
)


def drawings(groups: Sequence[Group]) -> Iterator[Drawing]:
    """Yield all figures of a report in their order."""
    with_trials = [group for group in groups if group.has_trials]
    lack = f"Not drawn without {_TRIALS}"
    without = _names(groups, with_trials)
    yield Drawing(
        "performance",
        "Test performance over training (K17 Fig. 2)",
        _PERFORMANCE,
        lambda: performance_figure(groups),
        f"Without quartiles, which need {_TRIALS}",
        without,
    )
    yield Drawing(
        "boxes",
        "Test performance at the end of training (K17 Fig. 3)",
        _BOXES,
        _of_any(box_figure, with_trials),
        lack,
        without,
    )
    yield from _motor_spaces(groups)
    # Muscles with commands of their own; joints have one error, which the others show.
    chosen = [g for g in with_trials if not (g.is_of_pair or g.last_trials.space.of_joints)]
    yield Drawing("errors", "Errors about all axes", _ERRORS, _of_any(errors_figure, chosen))
    for number, group in enumerate(chosen):
        draw = partial(activations_figure, group)
        name = f"activations_{number}_{group.model}"
        yield Drawing(name, f"Muscles of {group.name}", _ACTIVATIONS, draw)
    yield Drawing(
        "conditions",
        "Errors by distance and starting error",
        _CONDITIONS,
        _of_any(conditions_figure, with_trials),
        lack,
        without,
    )
    lambdas = _of_any(lambda_figure, over_lambda(groups))
    yield Drawing("lambda", "Accuracy and energy over lambda", _LAMBDA, lambdas)
    yield from _from_bags(groups)


def _of_any(
    draw: Callable[[Sequence[Group]], Figure | None], groups: Sequence[Group]
) -> Callable[[], Figure | None]:
    return lambda: draw(groups) if groups else None


def _names(groups: Sequence[Group], shown: Sequence[Group]) -> list[str]:
    """Return the names of the runs of groups that are not shown."""
    return [run.name for group in groups if group not in shown for run in group.runs]


def _motor_spaces(groups: Sequence[Group]) -> Iterator[Drawing]:
    """Yield a plane of activations for each plant."""
    shown = [group for group in groups if group.has_trials and group.is_of_pair]
    by_plant: dict[MechanicsConfig | None, list[Group]] = defaultdict(list)
    for group in shown:
        by_plant[group.last_mechanics].append(group)
    for number, (mechanics, members) in enumerate(by_plant.items() or [(None, [])]):
        yield Drawing(
            f"motor_space_{number}" if number else "motor_space",
            "Muscles and their cost (K17 Fig. 4)",
            _MOTOR_SPACE,
            partial(_motor_space, mechanics, members),
            f"Not drawn without {_TRIALS}, and {_PAIR}",
            _names(groups, shown),
        )


def _motor_space(mechanics: MechanicsConfig | None, groups: Sequence[Group]) -> Figure | None:
    if mechanics is None:
        return None
    chosen = sorted({round(i) for i in np.linspace(0, len(groups) - 1, _MOST_GROUPS)})
    return motor_space_figure(motor_space(mechanics), [groups[i] for i in chosen])


def _from_bags(groups: Sequence[Group]) -> Iterator[Drawing]:
    recorded = [group for group in groups if group.recorded_iterations]
    yield Drawing(
        "encoding",
        "Reconstruction error, from which the reward follows",
        _ENCODING,
        _of_any(encoding_figure, recorded),
        "Not drawn without a test in a bag, with enough observations in a bin",
        _names(groups, recorded),
    )
    for number, group in enumerate(groups):
        run, mark = group.runs[0], f"{number}_{group.model}"
        yield Drawing(
            f"dictionaries_{mark}",
            f"Basis functions of {run.name}",
            _DICTIONARIES,
            partial(_dictionaries, run),
            f"{run.name} has no checkpoint to take basis functions from",
        )
        yield Drawing(
            f"anaglyphs_{mark}",
            f"What the eyes of {run.name} see",
            _ANAGLYPHS,
            partial(anaglyph_figure, run),
            "Not drawn without a bag with images of a trial common to its first and last test",
        )


def _dictionaries(run: Run) -> Figure | None:
    if run.states is None:
        return None
    atoms = read_state(run.states / "sparse_coder.npz", "sparse_coder")["atoms"]
    return dictionary_figure(atoms, config_of(SparseCoderConfig, run.configuration).scales)
