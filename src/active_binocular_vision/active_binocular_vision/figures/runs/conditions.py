"""Test performance by what a trial starts from: where learning succeeded, and where it did not."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.image import AxesImage

from active_binocular_vision.figures.quartiles import px_deg_of, title_of
from active_binocular_vision.figures.style import LIGHT_GREY, SMALLEST_PT, panel_grid, title_panels
from active_binocular_vision.runs.groups import Group

# Colours reach from 1/16 px to 16 px; beyond a third of that on either side text is white.
_REACH = 16.0
_DARK = 6.0
_N_COLUMNS = 2


def conditions_figure(groups: Sequence[Group]) -> Figure:
    """Return the median |vergence error| after a trial by object distance and start error.

    groups: with trials. One panel each, of the last test; hatched where it has no trials.
    """
    figure, panels = panel_grid(len(groups), _N_COLUMNS, 2.7)
    px_deg = px_deg_of(groups)
    for axes, group in zip(panels, groups, strict=True):
        image = _draw(axes, group, px_deg)
    title_panels(panels, [title_of(group) for group in groups])
    colours = figure.colorbar(
        image, ax=panels, label="median |vergence error| / deg", shrink=0.8, extend="both"
    )
    labels = ["0.02", "0.1", f"{px_deg:.2f}\n(1 px)", "1", "3"]
    colours.set_ticks([0.02, 0.1, px_deg, 1.0, 3.0], labels=labels)
    colours.minorticks_off()
    return figure


def _draw(axes: Axes, group: Group, px_deg: float) -> AxesImage:
    trials = group.last_trials
    distance_m = trials.object_distance_m
    # Adding 0 makes what rounds to -0.0 a plain 0.
    start_deg = np.round(trials.vergence_error_deg[:, 0]) + 0.0
    end_deg = np.abs(trials.vergence_error_deg[:, -1])
    distances_m, starts_deg = np.unique(distance_m), np.unique(start_deg)
    medians_deg = np.full((len(distances_m), len(starts_deg)), np.nan)
    for i, j in np.ndindex(medians_deg.shape):
        here = (distance_m == distances_m[i]) & (start_deg == starts_deg[j])
        if here.any():
            medians_deg[i, j] = np.median(end_deg[here])
    image = axes.imshow(
        np.ma.masked_invalid(medians_deg),
        norm=LogNorm(px_deg / _REACH, px_deg * _REACH),
        cmap="RdBu_r",
        aspect="auto",
    )
    _write_values(axes, medians_deg, px_deg)
    axes.set_xticks(range(len(starts_deg)), [f"{value:.0f}" for value in starts_deg])
    axes.set_yticks(range(len(distances_m)), [f"{value:g}" for value in distances_m])
    axes.set(xlabel="vergence error at the start / deg", ylabel="object distance / m")
    axes.patch.set(hatch="///", edgecolor=LIGHT_GREY)
    return image


def _write_values(axes: Axes, medians_deg: np.ndarray, px_deg: float) -> None:
    for (i, j), value in np.ndenumerate(medians_deg):
        if not np.isnan(value):
            is_dark = max(value / px_deg, px_deg / max(value, px_deg / _REACH)) > _DARK
            colour = "white" if is_dark else "black"
            axes.text(
                j, i, f"{value:.2f}", ha="center", va="center", color=colour, fontsize=SMALLEST_PT
            )
