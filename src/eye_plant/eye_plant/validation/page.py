"""The page of figures that goes with the validation."""

from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from eye_plant.inverse.pair import Inverse
from eye_plant.mechanics.model import MechanicsConfig
from eye_plant.mechanics.muscle_curves import force_length, force_velocity, passive_force_length
from eye_plant.mechanics.oculomotor import Oculomotor
from eye_plant.validation.dynamic_checks import saccades
from eye_plant.validation.openeyesim import Maps, power_law_w
from eye_plant.validation.static_checks import pulling_directions
from lockstep.command_space import MUSCLES
from lockstep.figures import (
    BLUE,
    GREEN,
    GREY,
    SMALLEST_PT,
    STYLE,
    VERMILION,
    WIDTH_IN,
    new_figure,
    save,
    title_panels,
)

_USUAL = "2.2 ms/deg + 21 ms, within 25 %"
LEVELS_DEG = np.arange(-35.0, 36.0, 5.0)


def draw_page(path: Path, maps: Maps | None) -> None:
    """Draw the ten panels; maps adds OpenEyeSim's own gaze lines and costs to ours."""
    with mpl.rc_context(STYLE):
        figure = new_figure(WIDTH_IN, 14.5)
        panels = figure.subplots(5, 2).ravel()
        duration, velocity = panels[8:]
        titles = (
            _draw_gaze_map(panels[0], maps),
            _draw_cost_map(panels[1], maps),
            _draw_pulling_directions(panels[2]),
            _draw_force_length(panels[3]),
            _draw_force_velocity(panels[4]),
            _draw_cost_terms(panels[5]),
            _draw_step_responses(panels[6]),
            *_draw_saccades(panels[7], duration, velocity),
        )
        title_panels(panels, titles)
        save(figure, path)


def _legend(axis: Axes, n_columns: int = 2, **entries: Any) -> None:
    """Put a panel's legend below it, where it covers no data."""
    axis.legend(loc="upper center", bbox_to_anchor=(0.5, -0.22), ncols=n_columns, **entries)


def _draw_gaze_map(axis: Axes, maps: Maps | None) -> str:
    inverse = Inverse(MechanicsConfig())
    grid = np.linspace(0.0, 1.0, 11)
    gaze = np.array([[0.5 * inverse.vergence_deg(m, lat) for lat in grid] for m in grid])
    lines = axis.contour(grid, grid, gaze, LEVELS_DEG, colors=BLUE, linestyles="solid")
    # A label stands where its line crosses the other diagonal, so that none meets another.
    on_diagonal_deg = np.diag(gaze[::-1])
    labelled = LEVELS_DEG[(LEVELS_DEG % 10 == 0) & (np.abs(LEVELS_DEG) < on_diagonal_deg.max())]
    across = np.interp(-labelled, -on_diagonal_deg, grid)
    places = [(lateral, 1.0 - lateral) for lateral in across]
    axis.clabel(lines, labelled, fmt="%g", fontsize=SMALLEST_PT, manual=places)
    handles = [Line2D([], [], color=BLUE, label="k17 eyes")]
    if maps is not None:
        axis.contour(grid, grid, maps.adduction_deg, LEVELS_DEG, colors="k", linestyles="dotted")
        handles.append(Line2D([], [], color="k", ls=":", label="OpenEyeSim"))
    axis.set(xlabel="lateral rectus activation", ylabel="medial rectus activation")
    _legend(axis, handles=handles)
    return "k17 eyes: adduction / deg"


def _draw_cost_map(axis: Axes, maps: Maps | None) -> str:
    eyes = Oculomotor(MechanicsConfig())
    medial = np.linspace(0.0, 0.2, 60)
    for lateral, colour in ((0.1, VERMILION), (0.0, BLUE)):
        cost_w = []
        for activation in medial:
            eyes.settle(eyes.activations_from(activation, lateral))
            cost_w.append(0.5 * eyes.horizontal_metabolic_rate_w())
        axis.plot(medial, cost_w, color=colour, label=f"lateral rectus {lateral:g}")
        law_w = [power_law_w(activation, lateral) for activation in medial]
        axis.plot(medial, law_w, "k:", label="power law" if lateral == 0.0 else None)
        if maps is not None:
            reference_w = maps.cost_w[:3, round(10 * lateral)]
            label = "OpenEyeSim" if lateral == 0.0 else None
            axis.plot([0.0, 0.1, 0.2], reference_w, "o", color="k", mfc="none", label=label)
    axis.set(xlabel="medial rectus activation", ylabel="metabolic rate / W", ylim=(0.0, None))
    _legend(axis)
    return "k17 eyes: metabolic rate of one eye"


def _draw_pulling_directions(axis: Axes) -> str:
    directions_mm = pulling_directions(MechanicsConfig(parameter_set="anatomical"))
    positions = np.arange(len(MUSCLES))
    turns = ("adduction", "elevation", "intorsion")
    for i_axis, (name, colour) in enumerate(zip(turns, (BLUE, VERMILION, GREEN), strict=True)):
        at = positions + 0.27 * (i_axis - 1)
        axis.bar(at, directions_mm[:, i_axis], 0.27, color=colour, label=name)
    shown = [muscle.replace("_", "\n").replace("rior", "r.") for muscle in MUSCLES]
    axis.set_xticks(positions, shown, fontsize=SMALLEST_PT)
    axis.axhline(0.0, color="k", linewidth=0.8)
    axis.set_ylabel("lever arm / mm")
    _legend(axis, 3)
    return "anatomical eyes: pulling directions"


def _draw_force_length(axis: Axes) -> str:
    length = np.linspace(0.3, 2.0, 300)
    for parameter_set, style in (("k17", "--"), ("anatomical", "-")):
        muscles = MechanicsConfig(parameter_set=parameter_set).parameters.muscles
        # The anatomical ones are alike: both show.
        for name, colour, lw in (("medial_rectus", BLUE, 3.0), ("lateral_rectus", VERMILION, 1.4)):
            muscle = muscles[name]
            active = force_length(length, muscle.shortest, muscle.longest)
            passive = passive_force_length(length, muscle.longest, muscle.passive_stiffness)
            label = f"{parameter_set}, {name.replace('_', ' ')}"
            axis.plot(length, active, style, color=colour, lw=lw, label=label)
            axis.plot(length, passive, style, color=colour, lw=0.5 * lw)
    axis.set(
        xlabel="fibre length / optimal length",
        ylabel="force / peak isometric force",
        ylim=(0.0, 1.2),
    )
    _legend(axis)
    return "active and passive (thin) force"


def _draw_force_velocity(axis: Axes) -> str:
    velocity = np.linspace(-1.2, 0.6, 300)
    muscle = MechanicsConfig(parameter_set="anatomical").parameters.muscles["medial_rectus"]
    axis.plot(velocity, force_velocity(velocity, muscle.lengthening_gain), color=BLUE)
    axis.axhline(1.0, color="k", linewidth=0.5)
    axis.axvline(0.0, color="k", linewidth=0.5)
    axis.set(
        xlabel="velocity / maximal shortening velocity\n(shortening is negative)",
        ylabel="force / isometric force",
        xticks=np.arange(-1.0, 0.6, 0.5),
    )
    return "force and velocity of a muscle"


def _draw_cost_terms(axis: Axes) -> str:
    eyes = Oculomotor(MechanicsConfig(parameter_set="anatomical"))
    eyes.settle(eyes.tonic_activations)
    eyes.step(eyes.activations_from(0.2, 0.0))
    terms = eyes.metabolic_trace()
    time_ms = 1e3 * eyes.model.opt.timestep * np.arange(len(terms.work_w))
    for name, values_w, colour in (
        ("activation and maintenance", terms.activation_maintenance_w, BLUE),
        ("shortening and lengthening", terms.shortening_lengthening_w, VERMILION),
        ("work", terms.work_w, GREEN),
        ("total", terms.total_w, "k"),
    ):
        axis.plot(time_ms, 1e3 * values_w[:, 0], color=colour, label=name)
    axis.set(xlabel="time / ms", ylabel="metabolic rate / mW")
    _legend(axis)
    return "medial rectus, from tonic activation to 0.2"


def _draw_step_responses(axis: Axes) -> str:
    for parameter_set, style in (("k17", "--"), ("anatomical", "-")):
        eyes = Oculomotor(MechanicsConfig(parameter_set=parameter_set, timestep_s=1e-3))
        for medial, lateral, colour in ((0.2, 0.05, BLUE), (0.05, 0.1, VERMILION)):
            eyes.settle(eyes.tonic_activations)
            angles_deg = []
            for _ in range(400):
                eyes.advance(eyes.activations_from(medial, lateral), 1e-3)
                angles_deg.append(np.degrees(eyes.data.qpos[0]))
            label = f"{parameter_set}, to {medial:g} and {lateral:g}"
            axis.plot(angles_deg, style, color=colour, label=label)
    axis.set(xlabel="time / ms", ylabel="adduction / deg")
    _legend(axis)
    return "steps of medial and lateral rectus"


def _draw_saccades(trace: Axes, duration: Axes, velocity: Axes) -> tuple[str, str, str]:
    made = saccades()
    shades = mpl.colormaps["Blues"](np.linspace(0.35, 1.0, len(made)))
    for (amplitude_deg, saccade), shade in zip(made.items(), shades, strict=True):
        label = f"{amplitude_deg:g} deg"
        trace.plot(1e3 * saccade.time_s, saccade.adduction_deg, color=shade, label=label)
    trace.set(xlabel="time / ms", ylabel="adduction / deg", xlim=(0, 200))
    _legend(trace, 3)
    amplitudes = np.array(list(made))
    usual = 2.2 * amplitudes + 21.0
    duration.fill_between(
        amplitudes, 0.75 * usual, 1.25 * usual, color=GREY, alpha=0.2, lw=0, label=_USUAL
    )
    duration.plot(
        amplitudes, [s.duration_ms for s in made.values()], "o-", color=BLUE, label="simulated"
    )
    duration.set(xlabel="amplitude / deg", ylabel="duration / ms", ylim=(0.0, None))
    _legend(duration)
    peaks_deg_s = [s.peak_velocity_deg_s for s in made.values()]
    velocity.plot(amplitudes, peaks_deg_s, "o-", color=BLUE)
    velocity.set(xlabel="amplitude / deg", ylabel="peak velocity / (deg/s)", ylim=(0.0, 900.0))
    return "anatomical eyes: saccades", "main sequence: duration", "main sequence: peak velocity"
