"""K17 Fig. 4: gaze and metabolic rate over the plane of the two horizontal recti, with paths."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.figure import Figure

from experiment_manager.analysis.report.groups import Group
from experiment_manager.analysis.report.performance_figures import add_legend, new_figure
from experiment_manager.measures.criteria import Criteria
from experiment_manager.measures.trials import Trials
from eye_plant.geometry import desired_vergence_deg
from eye_plant.mechanics.model import MechanicsConfig
from eye_plant.mechanics.oculomotor import Oculomotor
from lockstep.command_space import HIGHEST_ACTIVATIONS

# Start errors whose paths are drawn, where a test has them (of K17's -3 to 3 deg).
_START_ERRORS_DEG = (-3.0, -1.0, 1.0, 3.0)
# Ends of a model's paths, drawn in this order: each shows where they fall together, too.
_ENDS: dict[str, dict[str, Any]] = {
    "M": {"marker": "o", "ms": 8, "mfc": "white"},
    "M_C": {"marker": "D", "ms": 4},
}
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
        rate_w[i, j] = eyes.horizontal_metabolic_rate_w(state.metabolic_rate_w)
    return MotorSpace(medial, lateral, vergence_deg, rate_w, mechanics.baseline_m)


def motor_space_figure(space: MotorSpace, groups: Sequence[Group]) -> Figure:
    """Return K17 Fig. 4: cost in grey, lines of equal gaze, and paths of the last test.

    Two panels, one for trials at the nearest and one at the farthest distance of the test; the
    solid line is correct gaze there, the dashed ones are 1 px off. Drawn are the trials of the
    first test stimulus, for start errors of -3, -1, 1 and 3 deg where there are; the median cost at
    their ends is written in the corner. groups: with trials.
    """
    figure = new_figure(7.2, 4.6)
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    criteria = groups[0].last_criteria
    last = [[run.trials[group.iterations[-1]] for run in group.runs] for group in groups]
    distances_m = last[0][0].object_distance_m
    for axes, distance_m in zip(panels, (distances_m.min(), distances_m.max()), strict=True):
        image = _draw_maps(axes, space, float(distance_m), criteria)
        costs_w = [
            _draw_paths(axes, tests, float(distance_m), group, i)
            for i, (group, tests) in enumerate(zip(groups, last, strict=True))
        ]
        _write_costs(axes, costs_w, [group.colour for group in groups])
        axes.set_title(f"object at {distance_m:g} m", fontsize=9)
        axes.set_xlabel("lateral rectus activation")
    panels[0].set_ylabel("medial rectus activation")
    panels[0].set(xlim=(0, _LATERAL_LIMIT), ylim=(0, _MEDIAL_LIMIT))
    figure.colorbar(image, ax=panels, label="metabolic rate $C$ / W", shrink=0.85)
    handles = [
        panels[0].plot([], [], color=group.colour, label=group.label, **_end(group))[0]
        for group in groups
    ]
    (silent,) = panels[0].plot([], [], ls=":", lw=0.9, color="#b35c00")
    silent.set_label(f"activation {criteria.silent_activation:g}: below, a muscle costs no less")
    add_legend(figure, [*handles, silent])
    return figure


def _end(group: Group) -> dict[str, Any]:
    return _ENDS.get(group.model, _ENDS["M_C"])


def _draw_maps(axes: Axes, space: MotorSpace, distance_m: float, criteria: Criteria) -> QuadMesh:
    image = axes.pcolormesh(
        space.lateral, space.medial, space.metabolic_rate_w, cmap="gray", shading="gouraud"
    )
    axes.contour(
        space.lateral, space.medial, space.metabolic_rate_w, 8, colors="white", linewidths=0.6
    )
    # The cost does not fall below this activation, so there its contours turn.
    axes.axhline(criteria.silent_activation, ls=":", lw=0.9, color="#b35c00")
    axes.axvline(criteria.silent_activation, ls=":", lw=0.9, color="#b35c00")
    desired_deg = desired_vergence_deg(distance_m, space.baseline_m)
    axes.contour(
        space.lateral,
        space.medial,
        space.vergence_deg,
        [desired_deg - criteria.px_deg, desired_deg, desired_deg + criteria.px_deg],
        colors="black",
        linestyles=["dashed", "solid", "dashed"],
        linewidths=[0.8, 1.4, 0.8],
    )
    return image


def _draw_paths(
    axes: Axes, tests: Sequence[Trials], distance_m: float, group: Group, i_group: int
) -> float:
    """Draw the paths of the trials shown; return the median metabolic rate at their ends, W."""
    ends_w: list[float] = []
    lw = 1.1 if len(tests) == 1 else 0.7
    for trials in tests:
        for i_trial in _shown_trials(trials, distance_m):
            medial, lateral = trials.activations[i_trial].T
            axes.plot(lateral, medial, color=group.colour, lw=lw, marker=".", ms=2.5, clip_on=False)
            axes.plot(
                lateral[-1],
                medial[-1],
                color=group.colour,
                mec=group.colour,
                zorder=5 + i_group,
                clip_on=False,
                **_end(group),
            )
            ends_w.append(float(trials.metabolic_rate_w[i_trial, -1]))
    return float(np.median(ends_w)) if ends_w else math.nan


def _write_costs(axes: Axes, costs_w: Sequence[float], colours: Sequence[str]) -> None:
    """Write one cost below the other into the corner that no path needs."""
    for i, (cost_w, colour) in enumerate(zip(reversed(costs_w), reversed(colours), strict=True)):
        axes.annotate(
            f"{cost_w:.2f} W",
            (1.0, 0.0),
            (-6, 6 + 15 * i),
            xycoords="axes fraction",
            textcoords="offset points",
            ha="right",
            fontsize=8,
            bbox={"facecolor": "white", "edgecolor": colour, "lw": 1.0, "pad": 1.5},
            zorder=20,
        )


def _shown_trials(trials: Trials, distance_m: float) -> list[int]:
    here = (trials.object_distance_m == distance_m) & (trials.stimulus == trials.stimulus.min())
    start_deg = trials.vergence_error_deg[:, 0]
    found = []
    for wanted_deg in _START_ERRORS_DEG:
        close = np.flatnonzero(here & (np.abs(start_deg - wanted_deg) < 0.5))
        found.extend(close[:1].tolist())
    return found
