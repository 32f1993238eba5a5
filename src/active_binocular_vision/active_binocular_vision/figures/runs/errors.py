"""The three errors of eyes whose muscles have commands of their own."""

from collections.abc import Sequence
from functools import partial

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from active_binocular_vision.figures.quartiles import (
    ERRORS,
    colour_of,
    draw_band,
    draw_quartiles,
    final_errors_deg,
    group_handle,
    marker_of,
    offset_of,
    over_training,
    px_deg_of,
    scale_errors,
)
from active_binocular_vision.figures.style import WIDTH_IN, legend_below, new_figure, title_panels
from active_binocular_vision.runs.groups import Group
from experiment_manager.measures.metrics import QUARTILES, REPORTED_ITERATIONS


def errors_figure(groups: Sequence[Group]) -> Figure:
    """Return horizontal, vertical and torsional errors, a column each; groups: with trials.

    Above, over the iterations of the last test's trials, as many as were kept; below, at their end
    over training. Median and quartiles of the absolute error.
    """
    figure = new_figure(WIDTH_IN, 5.2)
    rows = figure.subplots(2, len(ERRORS), sharex="row", sharey="all")
    for during, over, name in zip(*rows, ERRORS, strict=True):
        for i, group in enumerate(groups):
            draw_band(
                during, *_over_a_trial(group, name), colour_of(group), marker=marker_of(group), ms=3
            )
            finals = partial(final_errors_deg, name=name)
            draw_quartiles(over, over_training(group, finals), group, offset_of(i, groups))
        during.set_xlabel("iteration of the trial")
        over.set_xlabel("training iterations")
        over.xaxis.set_major_formatter(mpl.ticker.EngFormatter(sep=""))
    for axes, name in zip(rows.ravel(), [*ERRORS, *ERRORS], strict=True):
        # Pixels do not measure torsion.
        is_of_pixels = name != "cyclovergence_error_deg"
        scale_errors(axes, px_deg_of(groups), has_pixel=is_of_pixels)
    for axes in rows[:, 0]:
        axes.set_ylabel("|error| / deg")
    _scale_trial(rows[0, 0])
    title_panels(rows.ravel(), [*ERRORS.values(), *ERRORS.values()])
    legend_below(figure, [group_handle(group) for group in groups])
    return figure


def _scale_trial(axes: Axes) -> None:
    """Let the first iterations, in which most happens, take most of the width."""
    axes.set_xscale("symlog", linthresh=REPORTED_ITERATIONS[-2], linscale=1.5)
    axes.set_xlim(-0.3, REPORTED_ITERATIONS[-1] * 1.2)
    shown = (0, *REPORTED_ITERATIONS)
    axes.set_xticks(shown, [str(k) for k in shown])
    axes.xaxis.set_minor_locator(mpl.ticker.NullLocator())


def _over_a_trial(group: Group, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return iterations (n,) and quartiles of the absolute error (3, n)."""
    errors_deg = np.abs(group.last_trials.column(name))
    kept = np.flatnonzero(~np.isnan(errors_deg).all(axis=0))
    return kept, np.nanquantile(errors_deg[:, kept], QUARTILES, axis=0)
