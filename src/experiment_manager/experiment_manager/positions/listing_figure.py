"""The figure of Listing's law: torsion over elevation, and the displacement plane of each eye."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from experiment_manager.positions.examination import Examined
from experiment_manager.positions.listing import DisplacementPlane
from experiment_manager.positions.measures import planes_of_eyes
from lockstep.command_space import SIDES
from lockstep.figures import (
    BLUE,
    GREEN,
    LIGHT_GREY,
    VERMILION,
    WIDTH_IN,
    legend_below,
    new_figure,
    title_panels,
)

Array = NDArray[np.float64]

# How far gazes are turned to the temple in the middle of each group, and its colour.
_GROUPS = {"toward the nose": (-8.0, VERMILION), "between": (0.0, GREEN)}
_GROUPS |= {"toward the temple": (8.0, BLUE)}
_LIMITS_DEG = (-4.0, 4.0)


def listing_figure(examined: Examined) -> Figure:
    """Return torsion over elevation in Listing's coordinates, a panel for each distance and eye.

    Dots: the nine positions and the random places, medians over pictures. Lines: the displacement
    plane at gazes 8 deg toward the nose, straight ahead and 8 deg toward the temple.
    """
    distances_m = examined.nine.distances_m
    eyes = examined.nine.eyes, examined.random.eyes
    vectors = np.concatenate([np.median(p.rotation_vectors, axis=2) for p in eyes], axis=1)
    figure = new_figure(WIDTH_IN, 2.2 * len(distances_m) + 0.6)
    panels = figure.subplots(len(distances_m), len(SIDES), squeeze=False, sharex=True, sharey=True)
    titles = []
    planes = planes_of_eyes(examined)
    for i, distance_m in enumerate(distances_m):
        for i_side, side in enumerate(SIDES):
            plane = planes[side].by_distance[distance_m]
            _draw(panels[i, i_side], 2.0 * np.degrees(np.arctan(vectors[i, :, i_side])), plane)
            titles.append(f"{side} eye, {distance_m:g} m{_thickness(plane)}")
    title_panels(panels.ravel(), titles)
    for axes in panels[:, 0]:
        axes.set_ylabel("intorsion / deg")
    for axes in panels[-1]:
        axes.set_xlabel("elevation (up) / deg")
    handles = [
        Line2D([], [], color=colour, marker="o", ms=3.5, label=name)
        for name, (_, colour) in _GROUPS.items()
    ]
    legend_below(figure, handles)
    return figure


def _thickness(plane: DisplacementPlane | None) -> str:
    return f": thickness {plane.thickness_deg:.2f} deg" if plane else ""


def _draw(axes: Axes, angles_deg: Array, plane: DisplacementPlane | None) -> None:
    """Draw gazes of one eye, (n, 3) by torsion, down and temple, in Listing's coordinates."""
    torsion_deg, down_deg, temple_deg = angles_deg.T
    axes.axhline(0.0, color=LIGHT_GREY, lw=0.8, zorder=0)
    ends_deg = np.array([-down_deg.max(), -down_deg.min()])
    for i, (at_deg, colour) in enumerate(_GROUPS.values()):
        own = np.digitize(temple_deg, _LIMITS_DEG) == i
        axes.plot(-down_deg[own], torsion_deg[own], "o", color=colour, ms=3.5)
        if plane is not None:
            axes.plot(ends_deg, plane.torsion_deg(ends_deg, at_deg), color=colour, lw=1.0)
