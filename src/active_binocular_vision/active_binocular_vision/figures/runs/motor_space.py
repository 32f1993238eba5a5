"""K17 Fig. 4: gaze and metabolic rate over the plane of the two horizontal recti, with paths."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from active_binocular_vision.figures.quartiles import colour_of
from active_binocular_vision.figures.style import (
    GREEN,
    GREY,
    SMALLEST_PT,
    WIDTH_IN,
    legend_below,
    new_figure,
    title_panels,
)
from active_binocular_vision.runs.groups import Group
from experiment_manager import Criteria, Trials
from eye_plant import desired_vergence_deg
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from eye_plant.mechanics.oculomotor import Oculomotor
from lockstep.command_space import HIGHEST_ACTIVATIONS

# Start errors whose paths are drawn, where a test has them (of K17's -3 to 3 deg).
_START_ERRORS_DEG = (-3.0, -1.0, 1.0, 3.0)
# Ends of a model's paths, drawn in this order: each shows where they fall together, too.
_ENDS: dict[str, dict[str, Any]] = {
    "M": {"marker": "o", "ms": 8, "mfc": "white"},
    "M_C": {"marker": "D", "ms": 4},
}
# Labels of contours keep a tenth of each axis from its ends, and are so near to their level.
_MARGIN, _NEAR_W = 10, 0.02
_COST_COLOUR = "0.65"
_MEDIAL_LIMIT, _LATERAL_LIMIT = HIGHEST_ACTIVATIONS


@dataclass(frozen=True)
class MotorSpace:
    """Static maps of the plant over activations of medial and lateral rectus, both eyes alike.

    medial: (m,), lateral: (n,); vergence_deg, metabolic_rate_w (both eyes' horizontal recti):
    (m, n).
    """

    medial: np.ndarray
    lateral: np.ndarray
    vergence_deg: np.ndarray
    metabolic_rate_w: np.ndarray
    baseline_m: float


def motor_space(mechanics: MechanicsConfig, n_medial: int = 81, n_lateral: int = 41) -> MotorSpace:
    """Return the maps of a plant on K17's range, medial [0, 0.2] and lateral [0, 0.1]."""
    eyes = Oculomotor(mechanics)
    medial = np.linspace(0.0, _MEDIAL_LIMIT, n_medial)
    lateral = np.linspace(0.0, _LATERAL_LIMIT, n_lateral)
    vergence_deg = np.empty((n_medial, n_lateral))
    rate_w = np.empty((n_medial, n_lateral))
    for i, j in np.ndindex(n_medial, n_lateral):
        eyes.settle(eyes.activations_from(float(medial[i]), float(lateral[j])))
        state = eyes.state()
        vergence_deg[i, j] = math.degrees(float(state.eye_angles_rad[:, 0].sum()))
        rate_w[i, j] = eyes.horizontal_metabolic_rate_w()
    return MotorSpace(medial, lateral, vergence_deg, rate_w, mechanics.baseline_m)


def motor_space_figure(space: MotorSpace, groups: Sequence[Group]) -> Figure:
    """Return K17 Fig. 4: contours of cost, lines of equal gaze, and paths of the last test.

    Two panels, one for trials at the nearest and one at the farthest distance of the test; the
    solid line is correct gaze there, the dashed ones are 1 px off. Drawn are the trials of the
    first test stimulus, for start errors of -3, -1, 1 and 3 deg where there are. groups: with
    trials.
    """
    figure = new_figure(WIDTH_IN, 4.9)
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    criteria = groups[0].last_criteria
    last = [[run.tests[group.iterations[-1]] for run in group.runs] for group in groups]
    distances_m = last[0][0].object_distance_m
    titles = []
    for axes, distance_m in zip(panels, (distances_m.min(), distances_m.max()), strict=True):
        _draw_maps(axes, space, float(distance_m), criteria)
        n_trials = [
            _draw_paths(axes, tests, float(distance_m), group, i)
            for i, (group, tests) in enumerate(zip(groups, last, strict=True))
        ]
        titles.append(f"object at {distance_m:g} m, {_n_trials_text(groups, n_trials)}")
        axes.set_xlabel("lateral rectus activation")
    title_panels(panels, titles)
    panels[0].set_ylabel("medial rectus activation")
    panels[0].set(xlim=(0, _LATERAL_LIMIT), ylim=(0, _MEDIAL_LIMIT))
    legend_below(figure, _handles(groups, criteria))
    return figure


def _n_trials_text(groups: Sequence[Group], n_trials: Sequence[int]) -> str:
    """Return how many trials are drawn, in the order of the groups where that differs."""
    if len(set(n_trials)) == 1:
        return f"{n_trials[0]} trials of each model"
    counts = (f"{n} of {group.model}" for n, group in zip(n_trials, groups, strict=True))
    return f"trials: {', '.join(counts)}"


def _handles(groups: Sequence[Group], criteria: Criteria) -> list[Line2D]:
    n_iterations = groups[0].last_trials.n_iterations
    ends = [
        Line2D(
            [],
            [],
            color=colour_of(group),
            label=f"{group.label}: end of a trial",
            **_end(group),
        )
        for group in groups
    ]
    return [
        *ends,
        Line2D(
            [],
            [],
            color=GREY,
            lw=0.7,
            marker=".",
            ms=2.5,
            label=f"path of {n_iterations} iterations",
        ),
        Line2D([], [], color="black", label="gaze on the object"),
        Line2D([], [], color="black", ls="--", lw=0.8, label="1 px off"),
        Line2D([], [], color=_COST_COLOUR, lw=0.8, label="metabolic rate $C$ / W"),
        Line2D(
            [], [], color=GREEN, ls=":", label=f"activation {criteria.silent_activation:g}, silent"
        ),
    ]


def _end(group: Group) -> dict[str, Any]:
    return _ENDS.get(group.model, _ENDS["M_C"])


def _draw_maps(axes: Axes, space: MotorSpace, distance_m: float, criteria: Criteria) -> None:
    plane = (space.lateral, space.medial)
    cost = axes.contour(
        *plane, space.metabolic_rate_w, 8, colors=_COST_COLOUR, linewidths=0.8, zorder=1
    )
    # The cost does not fall below this activation, so there its contours turn.
    for draw in (axes.axhline, axes.axvline):
        draw(criteria.silent_activation, ls=":", lw=1.0, color=GREEN)
    desired_deg = desired_vergence_deg(distance_m, space.baseline_m)
    places = _label_places(space, cost.levels, desired_deg)
    axes.clabel(cost, fmt="%g", fontsize=SMALLEST_PT, manual=places)
    axes.contour(
        *plane,
        space.vergence_deg,
        [desired_deg - criteria.px_deg, desired_deg, desired_deg + criteria.px_deg],
        colors="black",
        linestyles=["dashed", "solid", "dashed"],
        linewidths=[0.8, 1.4, 0.8],
    )


def _label_places(
    space: MotorSpace, levels_w: Iterable[float], desired_deg: float
) -> list[tuple[float, float]]:
    """Return where on the contours there is room for a label: far from the line of gaze."""
    off_deg = np.abs(space.vergence_deg - desired_deg)
    inner = np.zeros_like(off_deg, dtype=bool)
    m, n = (size // _MARGIN for size in inner.shape)
    inner[m:-m, n:-n] = True
    places = []
    for level_w in levels_w:
        is_on = np.isclose(space.metabolic_rate_w, level_w, atol=_NEAR_W) & inner
        if is_on.any():
            i, j = np.unravel_index(np.where(is_on, off_deg, -1.0).argmax(), off_deg.shape)
            places.append((float(space.lateral[j]), float(space.medial[i])))
    return places


def _draw_paths(
    axes: Axes, tests: Sequence[Trials], distance_m: float, group: Group, i_group: int
) -> int:
    """Draw the paths of the trials shown; return how many they are."""
    shown = [trials.activations[i].T for trials in tests for i in _shown_trials(trials, distance_m)]
    lw = 1.1 if len(tests) == 1 else 0.7
    for medial, lateral in shown:
        axes.plot(lateral, medial, color=colour_of(group), lw=lw, marker=".", ms=2.5, clip_on=False)
        axes.plot(
            lateral[-1],
            medial[-1],
            color=colour_of(group),
            mec=colour_of(group),
            zorder=5 + i_group,
            clip_on=False,
            **_end(group),
        )
    return len(shown)


def _shown_trials(trials: Trials, distance_m: float) -> list[int]:
    here = (trials.object_distance_m == distance_m) & (trials.stimulus == trials.stimulus.min())
    start_deg = trials.vergence_error_deg[:, 0]
    found = []
    for wanted_deg in _START_ERRORS_DEG:
        close = np.flatnonzero(here & (np.abs(start_deg - wanted_deg) < 0.5))
        found.extend(close[:1].tolist())
    return found
