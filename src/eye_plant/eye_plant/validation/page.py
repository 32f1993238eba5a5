"""The page of figures that goes with the validation."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from eye_plant.inverse.pair import Inverse
from eye_plant.mechanics.model import MechanicsConfig
from eye_plant.mechanics.muscle_curves import force_length, force_velocity, passive_force_length
from eye_plant.mechanics.oculomotor import Oculomotor
from eye_plant.validation.dynamic_checks import saccades
from eye_plant.validation.openeyesim import Maps, power_law_w
from eye_plant.validation.static_checks import pulling_directions
from lockstep.command_space import MUSCLES

LEVELS_DEG = np.arange(-35.0, 36.0, 5.0)


def draw_page(path: Path, maps: Maps | None) -> None:
    """Draw the nine panels; maps adds OpenEyeSim's own gaze lines and costs to ours."""
    figure = Figure(figsize=(13.0, 11.5), layout="constrained")
    axes = figure.subplots(3, 3)
    _draw_gaze_map(axes[0, 0], maps)
    _draw_cost_map(axes[0, 1], maps)
    _draw_pulling_directions(axes[0, 2])
    _draw_force_length(axes[1, 0])
    _draw_force_velocity(axes[1, 1])
    _draw_cost_terms(axes[1, 2])
    _draw_step_responses(axes[2, 0])
    _draw_saccades(axes[2, 1], axes[2, 2])
    FigureCanvasAgg(figure).print_png(path)


def _draw_gaze_map(axis: Axes, maps: Maps | None) -> None:
    inverse = Inverse(MechanicsConfig())
    grid = np.linspace(0.0, 1.0, 11)
    gaze = np.array([[0.5 * inverse.vergence_deg(m, lat) for lat in grid] for m in grid])
    lines = axis.contour(grid, grid, gaze, LEVELS_DEG, colors="tab:blue")
    axis.clabel(lines, fmt="%g")
    title = "k17 adduction, deg"
    if maps is not None:
        axis.contour(grid, grid, maps.adduction_deg, LEVELS_DEG, colors="k", linestyles="dotted")
        title += " (dotted: OpenEyeSim)"
    axis.set(title=title, xlabel="lateral rectus activation", ylabel="medial rectus activation")


def _draw_cost_map(axis: Axes, maps: Maps | None) -> None:
    eyes = Oculomotor(MechanicsConfig())
    medial = np.linspace(0.0, 0.2, 60)
    for lateral, colour in ((0.0, "tab:blue"), (0.1, "tab:red")):
        cost_w = []
        for activation in medial:
            eyes.settle(eyes.activations_from(activation, lateral))
            rates_w = eyes.settled_metabolic_rate_w()
            cost_w.append(0.5 * eyes.horizontal_metabolic_rate_w(rates_w))
        axis.plot(medial, cost_w, color=colour, label=f"lateral {lateral:g}")
        law_w = [power_law_w(activation, lateral) for activation in medial]
        axis.plot(medial, law_w, "k:", label="power law" if lateral == 0.0 else None)
        if maps is not None:
            reference_w = maps.cost_w[:3, round(10 * lateral)]
            axis.plot([0.0, 0.1, 0.2], reference_w, "o", color=colour, label="OpenEyeSim")
    axis.set(title="k17 cost of one eye", xlabel="medial rectus activation", ylabel="W")
    axis.legend(fontsize=8)


def _draw_pulling_directions(axis: Axes) -> None:
    directions_mm = pulling_directions(MechanicsConfig(parameter_set="anatomical"))
    positions = np.arange(len(MUSCLES))
    for i_axis, name in enumerate(("adduction", "elevation", "intorsion")):
        axis.bar(positions + 0.27 * (i_axis - 1), directions_mm[:, i_axis], 0.27, label=name)
    axis.set_xticks(positions, [muscle.replace("_", "\n") for muscle in MUSCLES], fontsize=7)
    axis.axhline(0.0, color="k", linewidth=0.8)
    axis.set(title="anatomical pulling directions", ylabel="lever arm, mm")
    axis.legend(fontsize=8)


def _draw_force_length(axis: Axes) -> None:
    length = np.linspace(0.3, 2.0, 300)
    for parameter_set, style in (("k17", "--"), ("anatomical", "-")):
        muscles = MechanicsConfig(parameter_set=parameter_set).parameters.muscles
        for name, colour in (("medial_rectus", "tab:blue"), ("lateral_rectus", "tab:red")):
            muscle = muscles[name]
            active = force_length(length, muscle.shortest, muscle.longest)
            passive = passive_force_length(length, muscle.longest, muscle.passive_stiffness)
            label = f"{parameter_set} {name.replace('_', ' ')}"
            axis.plot(length, active, style, color=colour, label=label)
            axis.plot(length, passive, style, color=colour, linewidth=0.7)
    axis.set(
        title="force-length, active and passive (thin)",
        xlabel="fibre length, optimal lengths",
        ylabel="peak forces",
        ylim=(0.0, 1.2),
    )
    axis.legend(fontsize=7)


def _draw_force_velocity(axis: Axes) -> None:
    velocity = np.linspace(-1.2, 0.6, 300)
    muscle = MechanicsConfig(parameter_set="anatomical").parameters.muscles["medial_rectus"]
    axis.plot(velocity, force_velocity(velocity, muscle.lengthening_gain))
    axis.axhline(1.0, color="k", linewidth=0.5)
    axis.axvline(0.0, color="k", linewidth=0.5)
    axis.set(
        title="force-velocity",
        xlabel="velocity, maximal shortening velocities",
        ylabel="isometric forces",
    )


def _draw_cost_terms(axis: Axes) -> None:
    eyes = Oculomotor(MechanicsConfig(parameter_set="anatomical"))
    eyes.settle(eyes.tonic_activations)
    eyes.step(eyes.activations_from(0.2, 0.0))
    terms = eyes.metabolic_trace()
    time_ms = 1e3 * eyes.model.opt.timestep * np.arange(len(terms.work_w))
    for name, values_w in (
        ("activation, maintenance", terms.activation_maintenance_w),
        ("shortening, lengthening", terms.shortening_lengthening_w),
        ("work", terms.work_w),
        ("total", terms.total_w),
    ):
        axis.plot(time_ms, 1e3 * values_w[:, 0], label=name)
    axis.set(title="anatomical medial rectus, tonic to 0.2", xlabel="time, ms", ylabel="cost, mW")
    axis.legend(fontsize=8)


def _draw_step_responses(axis: Axes) -> None:
    for parameter_set, style in (("k17", "--"), ("anatomical", "-")):
        eyes = Oculomotor(MechanicsConfig(parameter_set=parameter_set, timestep_s=1e-3))
        for medial, lateral, colour in ((0.2, 0.05, "tab:blue"), (0.05, 0.1, "tab:red")):
            eyes.settle(eyes.tonic_activations)
            angles_deg = []
            for _ in range(400):
                eyes.advance(eyes.activations_from(medial, lateral), 1e-3)
                angles_deg.append(np.degrees(eyes.data.qpos[0]))
            label = f"{parameter_set} medial {medial:g}, lateral {lateral:g}"
            axis.plot(angles_deg, style, color=colour, label=label)
    axis.set(title="steps from tonic level", xlabel="time, ms", ylabel="adduction, deg")
    axis.legend(fontsize=7)


def _draw_saccades(trace: Axes, sequence: Axes) -> None:
    made = saccades()
    for amplitude_deg, saccade in made.items():
        trace.plot(1e3 * saccade.time_s, saccade.adduction_deg, label=f"{amplitude_deg:g} deg")
    trace.set(
        title="anatomical saccades", xlabel="time, ms", ylabel="adduction, deg", xlim=(0, 200)
    )
    amplitudes = np.array(list(made))
    durations = [saccade.duration_ms for saccade in made.values()]
    peaks = [saccade.peak_velocity_deg_s for saccade in made.values()]
    usual = 2.2 * amplitudes + 21.0
    sequence.fill_between(amplitudes, 0.75 * usual, 1.25 * usual, color="tab:blue", alpha=0.15)
    sequence.plot(amplitudes, durations, "o-", color="tab:blue")
    sequence.set(title="main sequence", xlabel="amplitude, deg", ylabel="duration, ms (blue)")
    velocity = sequence.twinx()
    velocity.plot(amplitudes, peaks, "s-", color="tab:red")
    velocity.set(ylabel="peak velocity, deg/s (red)", ylim=(0.0, 900.0))
