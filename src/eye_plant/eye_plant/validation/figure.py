"""The figure that goes with the checks: six panels, our eyes beside published values."""

from pathlib import Path
from string import ascii_lowercase

import matplotlib as mpl
import matplotlib.style
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from eye_plant.validation.checks import (
    ANATOMICAL,
    GRID,
    adduction_deg,
    cost_w,
    openeyesim_maps,
    power_law_w,
    pulling_directions,
    saccades,
    usual_duration_ms,
)
from lockstep.command_space import MUSCLES

# Okabe & Ito 2008: readers with any kind of colour vision can tell them apart.
_BLUE, _VERMILION, _GREEN = "#0072b2", "#d55e00", "#009e73"
_STYLE = {
    "font.size": 9,
    "axes.titlesize": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
}
_LEVELS_DEG = np.arange(-35.0, 36.0, 5.0)


def draw(path: Path) -> None:
    """Write the figure as PNG; OpenEyeSim's own lines and points only where its maps are there."""
    with mpl.style.context(("default", _STYLE)):
        figure = Figure(figsize=(8.0, 8.7), layout="constrained")
        panels = figure.subplots(3, 2).ravel()
        gaze, cost, directions, trace, duration, velocity = panels
        _draw_gaze(gaze)
        _draw_cost(cost)
        _draw_directions(directions)
        _draw_saccades(trace, duration, velocity)
        for letter, axes in zip(ascii_lowercase, panels, strict=False):
            axes.set_title(rf"$\bf{{{letter}}}$  {axes.get_title()}", loc="left")
            axes.set_title("")
        figure.savefig(path, dpi=150)


def _label(axes: Axes, title: str, x: str, y: str, n_columns: int = 2) -> None:
    """Name a panel and its axes; its legend stands below it, where it covers no data."""
    axes.set(title=title, xlabel=x, ylabel=y)
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.22), ncols=n_columns)


def _draw_gaze(axes: Axes) -> None:
    ours_deg = adduction_deg(GRID, GRID)
    lines = axes.contour(GRID, GRID, ours_deg, _LEVELS_DEG, colors=_BLUE, linestyles="solid")
    # A label stands where its line crosses the other diagonal, so that none meets another.
    diagonal_deg = np.diag(ours_deg[::-1])
    labelled = _LEVELS_DEG[(_LEVELS_DEG % 10 == 0) & (abs(_LEVELS_DEG) < diagonal_deg.max())]
    across = np.interp(-labelled, -diagonal_deg, GRID)
    axes.clabel(lines, labelled, fmt="%g", fontsize=8, manual=[(x, 1.0 - x) for x in across])
    axes.plot([], [], color=_BLUE, label="k17 eyes")
    if (maps := openeyesim_maps()) is not None:
        axes.contour(GRID, GRID, maps[0], _LEVELS_DEG, colors="k", linestyles="dotted")
        axes.plot([], [], "k:", label="OpenEyeSim")
    x, y = (f"{muscle} rectus activation" for muscle in ("lateral", "medial"))
    _label(axes, "k17 eyes: adduction / deg", x, y)


def _draw_cost(axes: Axes) -> None:
    medial, lateral, maps = np.linspace(0.0, 0.2, 60), GRID[:2], openeyesim_maps()
    ours_w, law_w = cost_w(medial, lateral), power_law_w(medial, lateral)
    for i, colour in ((1, _VERMILION), (0, _BLUE)):
        axes.plot(medial, ours_w[:, i], color=colour, label=f"lateral rectus {lateral[i]:g}")
    axes.plot(medial, law_w, "k:", label=["power law", None])
    if maps is not None:
        axes.plot(GRID[:3], maps[1][:3, :2], "ko", mfc="none", label=["OpenEyeSim", None])
    axes.set_ylim(0.0, None)
    title = "k17 eyes: metabolic rate of one eye"
    _label(axes, title, "medial rectus activation", "metabolic rate / W")


def _draw_directions(axes: Axes) -> None:
    directions_mm = pulling_directions(ANATOMICAL)
    positions = np.arange(len(MUSCLES))
    turns = ("adduction", "elevation", "intorsion")
    for i, (name, colour) in enumerate(zip(turns, (_BLUE, _VERMILION, _GREEN), strict=True)):
        axes.bar(positions + 0.27 * (i - 1), directions_mm[:, i], 0.27, color=colour, label=name)
    shown = [muscle.replace("_", "\n").replace("rior", "r.") for muscle in MUSCLES]
    axes.set_xticks(positions, shown, fontsize=8)
    axes.axhline(0.0, color="k", linewidth=0.8)
    _label(axes, "anatomical eyes: pulling directions", "", "lever arm / mm", 3)


def _draw_saccades(trace: Axes, duration: Axes, velocity: Axes) -> None:
    shades = mpl.colormaps["Blues"](np.linspace(0.35, 1.0, len(saccades())))
    for (amplitude_deg, saccade), shade in zip(saccades().items(), shades, strict=True):
        time_ms, label = 1e3 * saccade.time_s, f"{amplitude_deg:g} deg"
        trace.plot(time_ms, saccade.adduction_deg, color=shade, label=label)
    trace.set_xlim(0.0, 200.0)
    _label(trace, "anatomical eyes: saccades", "time / ms", "adduction / deg", 3)
    amplitudes_deg = np.array(list(saccades()))
    usual_ms = usual_duration_ms(amplitudes_deg)
    band = (amplitudes_deg, 0.75 * usual_ms, 1.25 * usual_ms)
    duration.fill_between(*band, color="0.85", label="2.2 ms/deg + 21 ms, within 25 %")
    durations_ms = [saccade.duration_ms for saccade in saccades().values()]
    duration.plot(amplitudes_deg, durations_ms, "o-", color=_BLUE, label="simulated")
    duration.set_ylim(0.0, None)
    _label(duration, "main sequence: duration", "amplitude / deg", "duration / ms")
    peaks_deg_s = [saccade.peak_velocity_deg_s for saccade in saccades().values()]
    velocity.plot(amplitudes_deg, peaks_deg_s, "o-", color=_BLUE)
    velocity.vlines(10.0, 300.0, 450.0, color="0.85", lw=8, label="bound at 10 deg", zorder=0)
    velocity.set_ylim(0.0, 900.0)
    title = "main sequence: peak velocity"
    _label(velocity, title, "amplitude / deg", "peak velocity / (deg/s)")
