"""The figures of the nine positions: gaze, what each muscle does there, and Listing's law."""

from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import Colormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle
from numpy.typing import NDArray

from active_binocular_vision.examinations.nine_positions.listing import DisplacementPlane
from active_binocular_vision.examinations.nine_positions.looking import NinePositionsTraces
from active_binocular_vision.examinations.nine_positions.measures import is_silent, planes_of_eyes
from active_binocular_vision.figures.style import (
    BLUE,
    GREEN,
    GREY,
    LIGHT_GREY,
    SMALLEST_PT,
    VERMILION,
    WIDTH_IN,
    legend_below,
    new_figure,
    title_panels,
)
from eye_plant import EyePlantConfig
from lockstep import SIDES
from lockstep.command_space import MUSCLES

Array = NDArray[np.float64]

_N_SIDE = 3
_ARROWS = ("↖", "↑", "↗", "←", "•", "→", "↙", "↓", "↘")
_ABBREVIATIONS = ["".join(word[0] for word in muscle.split("_")).upper() for muscle in MUSCLES]
_EXTRA = "active, silent with the least energy"
# Beyond the outermost gaze, and between ticks.
_MARGIN_DEG = 3.0
_TICKS_DEG = 5.0
_PANEL_WIDTH_IN = 3.5
# How far gazes are turned to the temple in the middle of each group, and its colour.
_LISTING_GROUPS = {"toward the nose": (-8.0, VERMILION), "between": (0.0, GREEN)}
_LISTING_GROUPS |= {"toward the temple": (8.0, BLUE)}
_LISTING_LIMITS_DEG = (-4.0, 4.0)


def hess_chart(examined: NinePositionsTraces) -> Figure:
    """Return the Hess chart: a row for each distance, a panel for each eye.

    Grey: where the eye should look. Blue: where it looks, medians over pictures.
    """
    nine = examined.nine
    reached_deg = np.median(nine.eyes.gaze_deg, axis=2)
    both_deg = np.stack([nine.wanted_gaze_deg, reached_deg])
    figure, panels = _chart_panels(both_deg.reshape(-1, 2), len(nine.distances_m))
    for of_distance, wanted, reached in zip(panels, *both_deg, strict=True):
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
    seen = f"gaze, median over n = {nine.pictures.shape[1]} stimuli"
    legend_below(
        figure,
        [
            Line2D([], [], color=GREY, marker="o", mfc="white", ms=7, label="required gaze"),
            Line2D([], [], color=BLUE, marker="o", ms=3.5, label=seen),
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
    figure, panels = _panels(
        n_distances, panel_height_in, "azimuth (right) / deg", "elevation (up) / deg"
    )
    for axes in panels.ravel():
        axes.axhline(0.0, color=LIGHT_GREY, lw=0.8, zorder=0)
        axes.axvline(0.0, color=LIGHT_GREY, lw=0.8, zorder=0)
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_locator(mpl.ticker.MultipleLocator(_TICKS_DEG))
    return figure, panels


def _panels(n_distances: int, height_in: float, x_label: str, y_label: str) -> tuple[Figure, Any]:
    """Return a figure with a panel of this height for each distance and eye."""
    figure = new_figure(WIDTH_IN, height_in * n_distances + 0.6)
    panels = figure.subplots(n_distances, len(SIDES), squeeze=False, sharex=True, sharey=True)
    for axes in panels[:, 0]:
        axes.set_ylabel(y_label)
    for axes in panels[-1]:
        axes.set_xlabel(x_label)
    return figure, panels


def activations_figure(examined: NinePositionsTraces) -> Figure:
    """Return activations of all muscles, medians over pictures; see `learned_beside_least`."""
    nine = examined.nine
    learned = np.median(nine.eyes.activations, axis=2)
    n, least = nine.pictures.shape[1], nine.optimum.activations
    return learned_beside_least(nine.distances_m, learned, least, examined.plant, n)


def learned_beside_least(
    distances_m: Sequence[float], learned: Array, least: Array, plant: EyePlantConfig, n: int
) -> Figure:
    """Return activations of all muscles: learned beside least energy, a row for each distance.

    learned, least: (n_distances, 9, 12). A column for each position; silent muscles are white,
    those framed that the least energy leaves silent. n: stimuli, over which learned ones are
    medians.
    """
    n_rows = len(distances_m)
    figure = new_figure(WIDTH_IN, 2.7 * n_rows + 1.0)
    panels = figure.subplots(n_rows, 2, sharex=True, sharey=True, squeeze=False)
    shown = np.stack([learned, least], axis=1)
    silent = is_silent(shown, plant)
    scale = mpl.colors.Normalize(0.0, float(np.nanmax(shown)))
    colours = mpl.colormaps["viridis_r"].with_extremes(bad="white")
    for row, *of_row in zip(panels, shown, silent, strict=True):
        for axes, activations, is_white in zip(row, *of_row, strict=True):
            image = _draw_activations(axes, activations, is_white, colours, scale)
        is_silent_here, is_silent_least = of_row[1]
        _frame(row[0], ~is_silent_here & is_silent_least)
    names = "learned", "least energy"
    title_panels(panels.ravel(), [f"{name}, {d:g} m" for d in distances_m for name in names])
    for axes in panels[-1]:
        axes.set_xlabel("gaze position")
    figure.colorbar(image, ax=panels, label="activation", shrink=0.6)
    handles = [
        Patch(facecolor="white", edgecolor=GREY, label="silent"),
        Patch(facecolor="none", edgecolor=VERMILION, lw=1.5, label=_EXTRA),
        Line2D([], [], ls="", label=f"learned: median over n = {n} stimuli"),
    ]
    if np.isnan(shown).any():
        label = "the muscles do not reach this gaze"
        handles.append(Patch(facecolor="white", edgecolor=GREY, hatch="////", label=label))
    legend_below(figure, handles)
    return figure


def _frame(axes: Axes, chosen: NDArray[np.bool_]) -> None:
    """Frame cells (9, 12) of a panel of activations."""
    for i_position, i_muscle in np.argwhere(chosen):
        place = (i_position - 0.5, i_muscle - 0.5)
        axes.add_patch(Rectangle(place, 1, 1, fc="none", ec=VERMILION, lw=1.5, zorder=3))


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


def listing_figure(examined: NinePositionsTraces) -> Figure:
    """Return torsion over elevation in Listing's coordinates, a panel for each distance and eye.

    Dots: the nine positions and the random places, medians over pictures. Lines: the displacement
    plane at gazes 8 deg toward the nose, straight ahead and 8 deg toward the temple.
    """
    distances_m = examined.nine.distances_m
    eyes = examined.nine.eyes, examined.random.eyes
    vectors = np.concatenate([np.median(p.rotation_vectors, axis=2) for p in eyes], axis=1)
    figure, panels = _panels(len(distances_m), 2.2, "elevation (up) / deg", "intorsion / deg")
    titles = []
    planes = planes_of_eyes(examined)
    for i, distance_m in enumerate(distances_m):
        for i_side, side in enumerate(SIDES):
            plane = planes[side].by_distance[distance_m]
            _draw_listing(
                panels[i, i_side], 2.0 * np.degrees(np.arctan(vectors[i, :, i_side])), plane
            )
            titles.append(f"{side} eye, {distance_m:g} m{_thickness(plane)}")
    title_panels(panels.ravel(), titles)
    handles = [
        Line2D([], [], color=colour, marker="o", ms=3.5, label=name)
        for name, (_, colour) in _LISTING_GROUPS.items()
    ]
    legend_below(figure, handles)
    return figure


def _thickness(plane: DisplacementPlane | None) -> str:
    return f": thickness {plane.thickness_deg:.2f} deg" if plane else ""


def _draw_listing(axes: Axes, angles_deg: Array, plane: DisplacementPlane | None) -> None:
    """Draw gazes of one eye, (n, 3) by torsion, down and temple, in Listing's coordinates."""
    torsion_deg, down_deg, temple_deg = angles_deg.T
    axes.axhline(0.0, color=LIGHT_GREY, lw=0.8, zorder=0)
    ends_deg = np.array([-down_deg.max(), -down_deg.min()])
    for i, (at_deg, colour) in enumerate(_LISTING_GROUPS.values()):
        own = np.digitize(temple_deg, _LISTING_LIMITS_DEG) == i
        axes.plot(-down_deg[own], torsion_deg[own], "o", color=colour, ms=3.5)
        if plane is not None:
            axes.plot(ends_deg, plane.torsion_deg(ends_deg, at_deg), color=colour, lw=1.0)
