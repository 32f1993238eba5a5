"""The figures of a report, with their captions, and what they need that a run may not have."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from matplotlib.figure import Figure

from experiment_manager.analysis.report.activation_figure import activations_figure
from experiment_manager.analysis.report.condition_figures import conditions_figure
from experiment_manager.analysis.report.dictionary_figures import dictionary_figure
from experiment_manager.analysis.report.error_figures import errors_figure
from experiment_manager.analysis.report.groups import Group
from experiment_manager.analysis.report.motor_space_figure import motor_space, motor_space_figure
from experiment_manager.analysis.report.performance_figures import box_figure, performance_figure
from experiment_manager.analysis.report.picture_figures import anaglyph_figure, encoding_figure
from experiment_manager.analysis.report.price_figure import over_prices, price_figure
from experiment_manager.analysis.report.reported_run import ReportedRun
from experiment_manager.run import checkpoint
from eye_plant.mechanics.model import MechanicsConfig
from lockstep.configuration import build
from lockstep.state_file import read_state

_PLANT_PREFIX = "mechanics."
# More than these cannot be told apart in one plane of activations; they are chosen evenly.
_MOST_GROUPS = 4
_NEEDS_TRIALS = "trials.npz or a bag"
_NEEDS_BAG = "a bag"
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
    yield Drawing(
        "performance",
        "Test performance over the course of training (K17 Fig. 2)",
        "Above: median and quartiles of the absolute vergence error (left), and median of the "
        "metabolic rate above the least possible one (right, dashed), over all trials of all "
        "seeds; thin lines are the medians of single seeds. Below: the same errors on a "
        "logarithmic axis.",
        lambda: performance_figure(groups),
        left_out=_left_out("Without quartiles, which need", _NEEDS_TRIALS, groups, _has_trials),
    )
    with_trials = [group for group in groups if group.has_trials]
    left_out = _left_out("Not drawn, for want of", _NEEDS_TRIALS, groups, _has_trials)
    yield Drawing(
        "boxes",
        "Test performance at the end of training (K17 Fig. 3)",
        "After iterations 1, 2, 3 and 20 of the trials. Boxes are quartiles, whiskers reach the "
        "last value within 1.5 interquartile ranges, values beyond are not drawn. c is not defined "
        "for trials that start within 10 mW of the least cost.",
        lambda: box_figure(with_trials) if with_trials else None,
        left_out,
        left_out,
    )
    yield from _motor_spaces(groups)
    yield from _of_own_commands(with_trials)
    yield Drawing(
        "conditions",
        "Where it succeeds, and where not",
        "Median absolute vergence error after the last test's trials in deg, by where the object "
        "stands and by the error that the trial starts with. White is 1 px, blue less, red more."
        + ("" if all(_is_of_pair(g) for g in groups) else " Starts are rounded to whole degrees."),
        lambda: conditions_figure(with_trials) if with_trials else None,
        left_out,
        left_out,
    )
    yield from _prices(groups)
    yield from _drawings_from_bags(groups)


def _motor_spaces(all_groups: Sequence[Group]) -> Iterator[Drawing]:
    title = "Muscles and their cost (K17 Fig. 4)"
    what = "Not drawn, for want of"
    reasons = [
        _left_out(what, _NEEDS_TRIALS, all_groups, _has_trials),
        _left_out(what, _NEEDS_PAIR, all_groups, _is_of_pair),
    ]
    left_out = " ".join(reason for reason in reasons if reason)
    groups = [group for group in all_groups if group.has_trials and group.is_of_pair]
    if not groups:
        yield Drawing("motor_space", title, "", lambda: None, left_out)
    for number, (mechanics, members) in enumerate(_by_plant(groups)):
        yield Drawing(
            f"motor_space_{number}" if number else "motor_space",
            title,
            "Metabolic rate (grey, white contours) over the activations of both eyes' horizontal "
            "recti. Black: gaze on the object, dashed: 1 px off. Paths of the last test's trials of"
            " the first stimulus that start at -3, -1, 1 and 3 deg of error, of all seeds; rings "
            "(M) and diamonds (M_C) are their ends, in the corner the median rate there, by the "
            "colour of the frame. Below the dotted activation of 0.005 the cost of a muscle does "
            "not fall any more, so the contours turn there. Of more than four settings, four.",
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
            "Above: over the iterations of the last test's trials, as many as were kept. Below: "
            "after a trial's last iteration, over training. Median and quartiles of the absolute "
            "error, over all trials of all seeds. Horizontal and vertical: disparity of what the "
            "left fovea looks at. Torsional: how far its surroundings are turned, eye against eye.",
            partial(errors_figure, chosen),
        )
    for number, group in enumerate(chosen):
        yield Drawing(
            f"activations_{number}_{group.model}",
            f"Muscles of {group.name}",
            "Activations at the start (rings) and at the end (dots) of the last test's trials, by "
            "object distance: median and quartiles over all trials of all seeds. Each panel has "
            "two antagonists.",
            partial(activations_figure, group),
        )


def _prices(groups: Sequence[Group]) -> Iterator[Drawing]:
    family = over_prices(groups)
    if family:
        yield Drawing(
            "price_of_energy",
            "What a price on energy does",
            "After 20 iterations of the last test's trials, over lambda: median and quartiles over "
            "all trials of all seeds, dots are the medians of single seeds. In the last panel the "
            "median error against the median metabolic rate, a point per lambda. Model M, which "
            "has no price, stands at 0 where there is no M_C with lambda 0.",
            lambda: price_figure(family),
        )


def _drawings_from_bags(groups: Sequence[Group]) -> Iterator[Drawing]:
    recorded = [group for group in groups if _has_bag(group)]
    left_out = _left_out("Not drawn, for want of", _NEEDS_BAG, groups, _has_bag)
    yield Drawing(
        "encoding",
        "What drives the learning",
        "Reconstruction error against vergence error in the first and the last test: median and "
        "quartiles over all iterations, in bins of 0.25 deg.",
        lambda: encoding_figure(recorded) if recorded else None,
        left_out or "Too few observations in any bin.",
        left_out,
    )
    for number, group in enumerate(groups):
        yield from _drawings_of_run(group.runs[0], f"{number}_{group.model}")


def _left_out(
    what: str, need: str, groups: Sequence[Group], is_there: Callable[[Group], bool]
) -> str:
    names = [run.name for group in groups if not is_there(group) for run in group.runs]
    return f"{what} {need}: {', '.join(names)}." if names else ""


def _has_trials(group: Group) -> bool:
    return group.has_trials


def _is_of_pair(group: Group) -> bool:
    return group.is_of_pair


def _has_bag(group: Group) -> bool:
    return any(run.recorded is not None for run in group.runs)


def _drawings_of_run(run: ReportedRun, mark: str) -> Iterator[Drawing]:
    yield Drawing(
        f"dictionaries_{mark}",
        f"Basis functions of {run.name}",
        "Left eye's part beside the right eye's, each pair scaled by its largest entry. First "
        "those with a preferred disparity, from the phases of a Gabor function fitted to both "
        "parts, positive when the pattern lies farther right in the left eye; then the others, the "
        "most alike in strength first. Below, how many prefer which disparity.",
        lambda: _dictionaries(run),
        f"{run.name} has no checkpoint to take basis functions from.",
    )
    recorded = run.recorded
    yield Drawing(
        f"anaglyphs_{mark}",
        f"What the eyes of {run.name} see",
        "One trial in the first and in the last test, at its start and at its end: left eye in red,"
        " right eye in cyan. Colour fringes are disparity; the frame is the coarse scale's window. "
        "Of the trials with pictures, the one that ends with the median error.",
        lambda: anaglyph_figure(recorded) if recorded is not None else None,
        f"Not drawn, for want of {_NEEDS_BAG} with pictures of a trial common to its first and last"
        " test.",
    )


def _dictionaries(run: ReportedRun) -> Figure | None:
    found = checkpoint.newest(run.directory / "checkpoints")
    if found is None:
        return None
    return dictionary_figure(read_state(found[1] / "sparse_coder.npz", "sparse_coder")["atoms"])


def _motor_space(mechanics: MechanicsConfig, groups: Sequence[Group]) -> Figure:
    chosen = sorted({round(i) for i in np.linspace(0, len(groups) - 1, _MOST_GROUPS)})
    return motor_space_figure(motor_space(mechanics), [groups[i] for i in chosen])


def _by_plant(groups: Sequence[Group]) -> list[tuple[MechanicsConfig, list[Group]]]:
    """Return the groups by the plant of their first runs."""
    found: list[tuple[MechanicsConfig, list[Group]]] = []
    for group in groups:
        mechanics = _mechanics(group.runs[0])
        for known, members in found:
            if known == mechanics:
                members.append(group)
                break
        else:
            found.append((mechanics, [group]))
    return found


def _mechanics(run: ReportedRun) -> MechanicsConfig:
    parameters = run.parameters("eye_plant")
    chosen = {
        name.removeprefix(_PLANT_PREFIX): value
        for name, value in parameters.items()
        if name.startswith(_PLANT_PREFIX)
    }
    return build(MechanicsConfig, chosen)
