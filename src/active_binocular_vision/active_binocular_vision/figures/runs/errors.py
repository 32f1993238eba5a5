"""The three errors of eyes whose muscles have commands of their own."""

from collections.abc import Sequence
from functools import partial
from itertools import pairwise
from operator import attrgetter
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from active_binocular_vision.figures.quartiles import (
    ERRORS,
    colour_of,
    draw_band,
    draw_bars,
    draw_quartiles,
    final_errors_deg,
    group_handle,
    interval_handles,
    marker_of,
    of_seeds,
    offset_of,
    over_training,
    px_deg_of,
    scale_errors,
)
from active_binocular_vision.figures.style import (
    WIDTH_IN,
    break_axis,
    legend_below,
    new_figure,
    title_panels,
)
from active_binocular_vision.runs.groups import Group
from experiment_manager.measures.metrics import QUARTILES

# Of iterations that are not joined, between two groups.
_ASIDE = 0.25


def errors_figure(groups: Sequence[Group]) -> Figure:
    """Return horizontal, vertical and torsional errors, a column each; groups: with trials.

    Above, over the iterations of the last test's trials, as many as were kept; below, at their end
    over training. Median and quartiles of the absolute error.
    """
    figure = new_figure(WIDTH_IN, 5.2)
    rows = figure.subplots(2, len(ERRORS), sharex="row", sharey="all")
    for during, over, name in zip(*rows, ERRORS, strict=True):
        for i, group in enumerate(groups):
            _draw_trial(during, group, name, offset_of(i, groups))
            finals = partial(final_errors_deg, name=name)
            seeds = of_seeds(group, attrgetter(f"median_abs_{name}"))
            draw_quartiles(over, over_training(group, finals), group, offset_of(i, groups), seeds)
        during.set_xlabel("iteration of the trial")
        over.set_xlabel("training iterations")
        over.xaxis.set_major_formatter(mpl.ticker.EngFormatter(sep=""))
    for axes, name in zip(rows.ravel(), [*ERRORS, *ERRORS], strict=True):
        # Pixels do not measure torsion.
        is_of_pixels = name != "cyclovergence_error_deg"
        scale_errors(axes, px_deg_of(groups), has_pixel=is_of_pixels)
    for axes in rows[:, 0]:
        axes.set_ylabel("|error| / deg")
    finals_kept = ~np.isnan(groups[0].last_trials.column(next(iter(ERRORS)))).all(axis=0)
    for axes in rows[0]:
        _scale_trial(axes, np.flatnonzero(finals_kept))
    title_panels(rows.ravel(), [*ERRORS.values(), *ERRORS.values()])
    legend_below(figure, [*map(group_handle, groups), *interval_handles(groups)])
    return figure


def _draw_trial(axes: Axes, group: Group, name: str, offset: float) -> None:
    """Draw quartiles of the absolute error over iterations: joined where none is left out."""
    errors_deg = np.abs(group.last_trials.column(name))
    kept = np.flatnonzero(~np.isnan(errors_deg).all(axis=0))
    quartiles = np.nanquantile(errors_deg[:, kept], QUARTILES, axis=0)
    n_joined = len(_joined(kept))
    look: dict[str, Any] = {"marker": marker_of(group), "ms": 3}
    draw_band(axes, kept[:n_joined], quartiles[:, :n_joined], colour_of(group), **look)
    later = _places(kept)[n_joined:] + _ASIDE * offset
    draw_bars(axes, later, quartiles[:, n_joined:], colour_of(group), **look)


def _scale_trial(axes: Axes, kept: np.ndarray) -> None:
    """Name iterations (n,); the axis is broken where some are left out."""
    places = _places(kept)
    n_joined = len(_joined(kept))
    if n_joined < len(kept):
        axes.set_xticks(places, [str(k) for k in kept])
        for before, after in pairwise(places[n_joined - 1 :]):
            break_axis(axes, (before + after) / 2)


def _joined(kept: np.ndarray) -> np.ndarray:
    """Return those of rising iterations (n,) before the first that is left out."""
    return kept[kept == np.arange(len(kept))]


def _places(kept: np.ndarray) -> np.ndarray:
    """Return where iterations (n,) stand: those after a gap two steps after the one before."""
    return np.cumsum(np.minimum(np.diff(kept, prepend=kept[0]), 2)).astype(float) + kept[0]
