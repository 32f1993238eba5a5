"""The three errors of eyes whose muscles have commands of their own."""

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from experiment_manager.analysis.report.groups import Group
from experiment_manager.analysis.report.performance_figures import (
    add_legend,
    label_decades,
    mark_pixel,
    new_figure,
    px_deg_of,
)
from experiment_manager.measures.metrics import REPORTED_ITERATIONS

_ERRORS = {
    "vergence_error_deg": "horizontal (vergence)",
    "vertical_error_deg": "vertical",
    "cyclovergence_error_deg": "torsional (cyclovergence)",
}
# Errors so much smaller than a pixel are not told apart.
_LEAST_PX = 0.02


def errors_figure(groups: Sequence[Group]) -> Figure:
    """Return horizontal, vertical and torsional errors, a column each; groups: with trials.

    Above, over the iterations of the last test's trials, as many as were kept; below, at their end
    over training. Median and quartiles of the absolute error.
    """
    figure = new_figure(8.4, 5.2)
    rows = figure.subplots(2, len(_ERRORS), sharex="row", sharey="all")
    px_deg = px_deg_of(groups)
    for during, over, (name, title) in zip(*rows, _ERRORS.items(), strict=True):
        for group in groups:
            _draw(during, *_over_a_trial(group, name), group.colour)
            _draw(over, *_over_training(group, name), group.colour)
        during.set_title(title, fontsize=9)
    for axes in rows[:, :-1].ravel():  # pixels do not measure torsion
        mark_pixel(axes, px_deg)
    _scale(rows[:, 0], px_deg)
    for axes in rows[0]:
        axes.set_xlabel("iteration of the trial")
    for axes in rows[1]:
        axes.set_xlabel("training iterations")
        axes.xaxis.set_major_formatter(mpl.ticker.EngFormatter(sep=""))
    add_legend(figure, [Line2D([], [], color=group.colour, label=group.label) for group in groups])
    return figure


def _scale(first: Sequence[Axes], px_deg: float) -> None:
    """Let the axes, of which the first of each row are given, show small errors and iterations."""
    for axes in first:
        axes.set(ylabel="|error| / deg", yscale="log")
    low, high = first[0].get_ylim()
    first[0].set_ylim(max(low, _LEAST_PX * px_deg), high)
    label_decades(first[0])
    during = first[0]
    # The first iterations, in which most happens, take most of the width.
    during.set_xscale("symlog", linthresh=REPORTED_ITERATIONS[-2], linscale=1.5)
    during.set_xlim(-0.3, REPORTED_ITERATIONS[-1] * 1.2)
    shown = (0, *REPORTED_ITERATIONS)
    during.set_xticks(shown, [str(k) for k in shown])
    during.xaxis.set_minor_locator(mpl.ticker.NullLocator())


def _over_a_trial(group: Group, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return iterations (n,) and quartiles of the absolute error (3, n)."""
    errors_deg = np.abs(group.last_trials.column(name))
    kept = np.flatnonzero(~np.isnan(errors_deg).all(axis=0))
    return kept, np.nanquantile(errors_deg[:, kept], (0.25, 0.5, 0.75), axis=0)


def _over_training(group: Group, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return training iterations (n,) and quartiles of the absolute error (3, n)."""
    errors_deg = [np.abs(group.trials_at(n).column(name)[:, -1]) for n in group.iterations]
    return np.array(group.iterations), np.nanquantile(errors_deg, (0.25, 0.5, 0.75), axis=1)


def _draw(axes: Axes, at: np.ndarray, quartiles_deg: np.ndarray, colour: str) -> None:
    lower_deg, median_deg, upper_deg = quartiles_deg
    axes.fill_between(at, lower_deg, upper_deg, color=colour, alpha=0.2, lw=0)
    axes.plot(at, median_deg, color=colour, marker="o", ms=3)
