"""The figure of accommodation: response, AC/A and CA/C, beside human ones."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from active_binocular_vision.examinations.lenses.accommodation import (
    COVERED,
    LENSES,
    NORMS,
    PRISMS,
    RESPONSE,
    AccommodationTraces,
    Norm,
)
from active_binocular_vision.figures.quartiles import draw_band
from active_binocular_vision.figures.style import (
    BLUE,
    GREY,
    LIGHT_GREY,
    VERMILION,
    WIDTH_IN,
    legend_below,
    new_figure,
    title_panels,
)
from experiment_manager.measures.metrics import QUARTILES

Array = NDArray[np.float64]


def accommodation_figure(found: AccommodationTraces) -> Figure:
    """Return accommodation over objects and lenses, vergence over it, and it over vergence."""
    figure = new_figure(WIDTH_IN, 3.4)
    panels = figure.subplots(1, 3)
    _draw_response(panels[0], found)
    covered = found.accommodation_d[COVERED], found.vergence_pd[COVERED]
    prisms = found.vergence_pd[PRISMS], found.accommodation_d[PRISMS]
    _draw_slope(panels[1], covered, NORMS["response_ac_a"], found.geometry_pd_d)
    panels[1].set(xlabel="accommodation / D", ylabel="vergence / PD")
    _draw_slope(panels[2], prisms, NORMS["ca_c"], 1.0 / found.geometry_pd_d)
    panels[2].set(xlabel="vergence / PD", ylabel="accommodation / D")
    title_panels(panels, ["objects and lenses", "AC/A: lenses, one eye", "CA/C: prisms, pinholes"])
    n_pictures = len(found.accommodation_d[RESPONSE])
    handles = [
        Line2D([], [], color=BLUE, marker="o", ms=3.5, label="median, quartiles"),
        Line2D([], [], color=VERMILION, marker="s", ms=3.5, label="the same, lenses"),
        Patch(color=LIGHT_GREY, label="human slopes"),
        Line2D([], [], color=GREY, ls="--", lw=1.0, label="each object fused and in focus"),
        Line2D([], [], ls="", label=f"n = {n_pictures} stimuli"),
    ]
    legend_below(figure, handles)
    return figure


def _draw_response(axes: Axes, found: AccommodationTraces) -> None:
    objects_d = found.stimuli[RESPONSE]
    ends_d = np.array([0.0, objects_d.max()])
    _draw_norm(axes, ends_d, (0.0, 0.0), NORMS["response"])
    axes.plot(ends_d, ends_d, color=GREY, ls="--", lw=1.0)
    for test, stimuli_d, colour, marker in (
        (RESPONSE, objects_d, BLUE, "o"),
        (LENSES, found.distance_d - found.stimuli[LENSES], VERMILION, "s"),
    ):
        quartiles = np.quantile(found.accommodation_d[test], QUARTILES, axis=0)
        draw_band(axes, stimuli_d, quartiles, colour, marker=marker, ms=3.5)
    axes.set(xlabel="stimulus / D", ylabel="accommodation / D")


def _draw_slope(axes: Axes, seen: Sequence[Array], norm: Norm, geometry: float) -> None:
    """Draw y over x of each stimulus, medians with quartiles; lines go through the middle one."""
    lower, middle, upper = (np.array(of) for of in np.quantile(seen, QUARTILES, axis=1))
    i_without = middle.shape[1] // 2
    centre = middle[0, i_without], middle[1, i_without]
    reach = max(float(np.abs(middle[0] - centre[0]).max()), 0.5)
    ends = centre[0] + np.array([-reach, reach])
    _draw_norm(axes, ends, centre, norm)
    axes.plot(ends, centre[1] + geometry * (ends - centre[0]), color=GREY, ls="--", lw=1.0)
    axes.errorbar(
        middle[0],
        middle[1],
        xerr=np.abs([lower[0], upper[0]] - middle[0]),
        yerr=np.abs([lower[1], upper[1]] - middle[1]),
        fmt="o-",
        color=BLUE,
        ms=3.5,
        elinewidth=0.8,
    )


def _draw_norm(axes: Axes, ends: Array, centre: tuple[float, float], norm: Norm) -> None:
    low, high = (centre[1] + slope * (ends - centre[0]) for slope in (norm.low, norm.high))
    axes.fill_between(ends, low, high, color=LIGHT_GREY, lw=0)
