"""The figure of saccades over time and of their main sequence, beside human ones."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from active_binocular_vision.examinations.saccades.main_sequence import MainSequenceTraces
from active_binocular_vision.figures.style import (
    BLUE,
    GREEN,
    GREY,
    PURPLE,
    VERMILION,
    WIDTH_IN,
    label_decades,
    legend_below,
    new_figure,
    title_panels,
)
from eye_plant.mechanics.movement import angles_deg

# Hopf, Liesenfeld, Schmidtmann, Ashayer & Pitz 2018, reflexive saccades of 100 people: distance of
# the target in deg, mean and SD of peak velocity in deg/s.
HUMAN_HORIZONTAL = np.array([(5.0, 213.0, 29.0), (15.0, 352.0, 50.0), (30.0, 455.0, 67.0)])
HUMAN_VERTICAL = np.array([(5.0, 208.0, 36.0), (10.0, 303.0, 50.0), (20.0, 391.0, 71.0)])

_SHOWN_S = 1.0


def main_sequence_figure(found: MainSequenceTraces) -> Figure:
    """Return saccades to the right over time, and peak velocity over amplitude of all."""
    figure = new_figure(WIDTH_IN, 3.8)
    panels = figure.subplots(1, 2)
    _draw_course(panels[0], found)
    _draw_main_sequence(panels[1], found)
    title_panels(panels, ["saccades to the right", "main sequence"])
    legend_below(figure, panels[1].get_legend_handles_labels()[0])
    return figure


def _draw_course(axes: Axes, found: MainSequenceTraces) -> None:
    sideways = [(row, movement) for row, movement in found.saccades if not row.direction_deg]
    for _, movement in sideways:
        time_s, sight = movement.time_s, movement.sight
        shown = time_s <= _SHOWN_S
        axes.plot(1e3 * time_s[shown], angles_deg(sight[0], sight[shown]), color=BLUE)
    end_ms = 1e3 * found.period_s
    axes.axvline(end_ms, color=GREY, ls=":", lw=1.0)
    axes.annotate(
        "control period ends", (end_ms, 1.0), (3, -9), ("data", "axes fraction"), "offset points"
    )
    axes.set(xlabel="time after the command / ms", ylabel="turn of the left line of sight / deg")
    targets_deg = [row.target_deg for row, _ in sideways]
    axes.set_yticks(targets_deg)
    axes.set_ylim(0.0, 1.15 * max(targets_deg))


def _draw_main_sequence(axes: Axes, found: MainSequenceTraces) -> None:
    rows = [row for row, _ in found.saccades]
    for name, colour, marker, quarter_deg in (
        ("horizontal", BLUE, "o", 0.0),
        ("vertical", VERMILION, "s", 90.0),
        ("oblique", GREEN, "x", 45.0),
    ):
        period_deg = 90.0 if name == "oblique" else 180.0
        of = [row for row in rows if (row.direction_deg or 0.0) % period_deg == quarter_deg]
        velocities_deg_s = [row.peak_velocity_deg_s for row in of]
        amplitudes_deg = [row.amplitude_deg for row in of]
        axes.plot(amplitudes_deg, velocities_deg_s, marker, color=colour, ms=4, label=name)
    all_deg = [row.amplitude_deg for row in rows]
    amplitude_deg = np.geomspace(min(all_deg), max(all_deg))
    velocity_deg_s = found.fit.peak_velocity_deg_s(amplitude_deg)
    axes.plot(amplitude_deg, velocity_deg_s, color=GREY, label="fit to all")
    for name, marker, human in (
        ("humans, horizontal, mean and SD", "D", HUMAN_HORIZONTAL),
        ("humans, vertical, mean and SD", "^", HUMAN_VERTICAL),
    ):
        at_deg, mean, sd = human.T
        axes.errorbar(at_deg, mean, sd, fmt=marker, color=PURPLE, ms=4, lw=1.0, label=name)
    axes.set_xscale("log")
    label_decades(axes)
    axes.set_xticks((1, 2, 5, 10, 20, 30), labels=["1", "2", "5", "10", "20", "30"])
    axes.set_xticks([], minor=True)
    axes.set(xlabel="amplitude / deg", ylabel="peak velocity / (deg/s)")
