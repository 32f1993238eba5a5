"""The figures of the nine positions: where the eyes look, and what each muscle does there."""

from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import Colormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from experiment_manager.positions.examination import Examined
from experiment_manager.positions.measures import is_silent
from lockstep.command_space import MUSCLES, SIDES
from lockstep.figures import (
    BLUE,
    GREY,
    LIGHT_GREY,
    SMALLEST_PT,
    WIDTH_IN,
    legend_below,
    new_figure,
    title_panels,
)

Array = NDArray[np.float64]

_N_SIDE = 3
_ARROWS = ("↖", "↑", "↗", "←", "•", "→", "↙", "↓", "↘")
_ABBREVIATIONS = ["".join(word[0] for word in muscle.split("_")).upper() for muscle in MUSCLES]
# Beyond the outermost gaze, and between ticks.
_MARGIN_DEG = 3.0
_TICKS_DEG = 5.0
_PANEL_WIDTH_IN = 3.5


def hess_chart(examined: Examined) -> Figure:
    """Return the Hess chart: a row for each distance, a panel for each eye.

    Grey: where the eye should look. Blue: where it looks, medians over pictures.
    """
    nine = examined.nine
    wanted_deg = nine.wanted_gaze_deg(examined.positions_m)
    reached_deg = np.median(nine.eyes.gaze_deg, axis=2)
    both_deg = np.stack([wanted_deg, reached_deg])
    figure, panels = _chart_panels(both_deg.reshape(-1, 2), len(nine.distances_m))
    for of_distance, wanted, reached in zip(panels, wanted_deg, reached_deg, strict=True):
        for axes, wanted_of_eye, reached_of_eye in zip(
            of_distance, wanted.swapaxes(0, 1), reached.swapaxes(0, 1), strict=True
        ):
            _draw_grid(axes, wanted_of_eye, GREY, marker="o", mfc="white", ms=7)
            _draw_grid(axes, reached_of_eye, BLUE, marker="o", ms=3.5)
    titles = [
        f"{side} eye{' (covered)' if side == examined.covered else ''}, {distance_m:g} m"
        for distance_m in nine.distances_m
        for side in SIDES
    ]
    title_panels(panels.ravel(), titles)
    legend_below(
        figure,
        [
            Line2D([], [], color=GREY, marker="o", mfc="white", ms=7, label="required gaze"),
            Line2D([], [], color=BLUE, marker="o", ms=3.5, label="gaze, median over pictures"),
        ],
    )
    return figure


def _draw_grid(axes: Axes, gaze_deg: Array, colour: str, **marks: Any) -> None:
    """Join the nine gazes (9, 2) along rows and columns."""
    grid = gaze_deg.reshape(_N_SIDE, _N_SIDE, 2)
    for line in (*grid, *grid.swapaxes(0, 1)):
        axes.plot(*line.T, color=colour, lw=1.0, **marks)


def _chart_panels(gazes_deg: Array, n_distances: int) -> tuple[Figure, Any]:
    """Return a figure and its panels (n_distances, 2), all with a frame around gazes (n, 2)."""
    low, high = gazes_deg.min(axis=0) - _MARGIN_DEG, gazes_deg.max(axis=0) + _MARGIN_DEG
    width, height = high - low
    panel_height_in = _PANEL_WIDTH_IN * height / width + 0.4
    figure = new_figure(WIDTH_IN, panel_height_in * n_distances + 0.6)
    panels = figure.subplots(n_distances, len(SIDES), squeeze=False, sharex=True, sharey=True)
    for axes in panels.ravel():
        axes.axhline(0.0, color=LIGHT_GREY, lw=0.8, zorder=0)
        axes.axvline(0.0, color=LIGHT_GREY, lw=0.8, zorder=0)
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_locator(mpl.ticker.MultipleLocator(_TICKS_DEG))
    for axes in panels[:, 0]:
        axes.set_ylabel("elevation (up) / deg")
    for axes in panels[-1]:
        axes.set_xlabel("azimuth (right) / deg")
    return figure, panels


def activations_figure(examined: Examined) -> Figure:
    """Return activations of all muscles: learned beside least energy, nearest above farthest.

    Medians over pictures; a column for each position, silent muscles white.
    """
    nine = examined.nine
    of_eyes = np.median(nine.eyes.activations, axis=2)
    figure = new_figure(WIDTH_IN, 7.6)
    panels = figure.subplots(2, 2, sharex=True, sharey=True)
    shown = [part[i] for i in (0, -1) for part in (of_eyes, nine.optimum.activations)]
    scale = mpl.colors.Normalize(0.0, float(np.nanmax(shown)))
    colours = mpl.colormaps["viridis_r"].with_extremes(bad="white")
    for axes, activations in zip(panels.ravel(), shown, strict=True):
        silent = is_silent(activations, examined.learners.plant)
        image = _draw_activations(axes, activations, silent, colours, scale)
    distances_m = nine.distances_m[0], nine.distances_m[-1]
    names = "learned", "least energy"
    title_panels(panels.ravel(), [f"{name}, {d:g} m" for d in distances_m for name in names])
    for axes in panels[-1]:
        axes.set_xlabel("gaze position")
    figure.colorbar(image, ax=panels, label="activation", shrink=0.6)
    handles = [Patch(facecolor="white", edgecolor=GREY, label="silent")]
    if np.isnan(shown).any():
        label = "the muscles do not reach this gaze"
        handles.append(Patch(facecolor="white", edgecolor=GREY, hatch="////", label=label))
    legend_below(figure, handles)
    return figure


def _draw_activations(
    axes: Axes,
    activations: Array,
    silent: NDArray[np.bool_],
    colours: Colormap,
    scale: mpl.colors.Normalize,
) -> mpl.image.AxesImage:
    """Draw activations (9, 12), a row for each muscle."""
    image = axes.imshow(
        np.where(silent, np.nan, activations).T, cmap=colours, norm=scale, aspect="auto"
    )
    for i in np.flatnonzero(np.isnan(activations).any(axis=1)):
        axes.axvspan(i - 0.5, i + 0.5, facecolor="white", edgecolor=GREY, hatch="////", lw=0.0)
    _label(axes)
    return image


def _label(axes: Axes) -> None:
    n_muscles = len(_ABBREVIATIONS) * len(SIDES)
    axes.set_xticks(range(len(_ARROWS)), _ARROWS, fontsize=11)
    labels = [f"{side[0].upper()} {name}" for side in SIDES for name in _ABBREVIATIONS]
    axes.set_yticks(range(n_muscles), labels, fontsize=SMALLEST_PT)
    axes.set_xticks(np.arange(len(_ARROWS) - 1) + 0.5, minor=True)
    axes.set_yticks(np.arange(n_muscles - 1) + 0.5, minor=True)
    axes.grid(which="minor", color=LIGHT_GREY, lw=0.6)
    axes.tick_params(which="minor", length=0)
    axes.axhline(n_muscles / 2 - 0.5, color="black", lw=1.0)
    for spine in axes.spines.values():
        spine.set_visible(True)
