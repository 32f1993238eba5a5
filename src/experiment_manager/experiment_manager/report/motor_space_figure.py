"""K17 Fig. 4: gaze and metabolic rate over the plane of the two horizontal recti, with paths."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.figure import Figure

from experiment_manager.measures.metrics import PX_DEG
from experiment_manager.measures.recorded_run import RecordedTest
from experiment_manager.report.groups import Group
from experiment_manager.report.performance_figures import new_figure
from eye_plant.mechanics.model import MechanicsConfig
from eye_plant.mechanics.oculomotor import Oculomotor

# Start errors whose paths are drawn, where a test has them (of K17's -3 to 3 deg).
_START_ERRORS_DEG = (-3.0, -1.0, 1.0, 3.0)
_END_COLOUR = "#d62728"
_MEDIAL_LIMIT, _LATERAL_LIMIT = 0.2, 0.1


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
    first test stimulus of each group's first run, for start errors of -3, -1, 1 and 3 deg where
    there are; a path's red dot is its end, the median cost there is written in the corner.
    """
    figure = new_figure(7.2, 4.6)
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    last = [group.tests_at(group.iterations[-1])[0] for group in groups]
    distances_m = last[0].trials.object_distance_m
    for axes, distance_m in zip(panels, (distances_m.min(), distances_m.max()), strict=True):
        image = _draw_maps(axes, space, float(distance_m))
        costs_w = [
            _draw_paths(axes, test, float(distance_m), group.colour)
            for group, test in zip(groups, last, strict=True)
        ]
        _write_costs(axes, costs_w, [group.colour for group in groups])
        axes.set_title(f"object at {distance_m:g} m", fontsize=9)
        axes.set_xlabel("lateral rectus activation")
    panels[0].set_ylabel("medial rectus activation")
    panels[0].set(xlim=(0, _LATERAL_LIMIT), ylim=(0, _MEDIAL_LIMIT))
    figure.colorbar(image, ax=panels, label="metabolic rate $C$ / W", shrink=0.85)
    handles = [panels[0].plot([], [], color=group.colour, label=group.label)[0] for group in groups]
    handles += panels[0].plot([], [], "o", color=_END_COLOUR, ms=4, label="after the trial")
    figure.legend(handles=handles, loc="outside lower center", ncols=min(2, len(handles)))
    return figure


def _draw_maps(axes: Axes, space: MotorSpace, distance_m: float) -> QuadMesh:
    image = axes.pcolormesh(
        space.lateral, space.medial, space.metabolic_rate_w, cmap="gray", shading="gouraud"
    )
    axes.contour(
        space.lateral, space.medial, space.metabolic_rate_w, 8, colors="white", linewidths=0.6
    )
    desired_deg = math.degrees(2.0 * math.atan(space.baseline_m / (2.0 * distance_m)))
    axes.contour(
        space.lateral,
        space.medial,
        space.vergence_deg,
        [desired_deg - PX_DEG, desired_deg, desired_deg + PX_DEG],
        colors="black",
        linestyles=["dashed", "solid", "dashed"],
        linewidths=[0.8, 1.4, 0.8],
    )
    return image


def _draw_paths(axes: Axes, test: RecordedTest, distance_m: float, colour: str) -> float:
    """Draw the paths of the trials shown; return the median metabolic rate at their ends, W."""
    shown = _shown_trials(test, distance_m)
    for i_trial in shown:
        medial, lateral = test.trials.activations[i_trial].T
        axes.plot(lateral, medial, color=colour, lw=1.1, marker=".", ms=2.5, clip_on=False)
        axes.plot(lateral[-1], medial[-1], "o", color=_END_COLOUR, ms=4, zorder=5, clip_on=False)
    return float(np.median(test.trials.metabolic_rate_w[shown, -1]))


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
            zorder=6,
        )


def _shown_trials(test: RecordedTest, distance_m: float) -> list[int]:
    trials = test.trials
    here = (trials.object_distance_m == distance_m) & (trials.stimulus == trials.stimulus.min())
    start_deg = trials.vergence_error_deg[:, 0]
    found = []
    for wanted_deg in _START_ERRORS_DEG:
        close = np.flatnonzero(here & (np.abs(start_deg - wanted_deg) < 0.5))
        found.extend(close[:1].tolist())
    return found
