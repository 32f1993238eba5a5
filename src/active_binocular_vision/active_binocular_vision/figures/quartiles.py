"""Medians with quartiles as bands or bars, and axes of errors, alike in all figures."""

import textwrap
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.lines import Line2D

from active_binocular_vision.figures.style import (
    BAND_ALPHA,
    BLUE,
    VERMILION,
    label_decades,
    mark_level,
    scale_by_decades,
)
from active_binocular_vision.runs.groups import Group
from experiment_manager import Summary, Trials
from experiment_manager.measures.metrics import QUARTILES
from experiment_manager.measures.seeds import over_seeds

# One name for each, in figures as in tables.
ERROR_LABEL = "|vergence error| / deg"
DELTA_LABEL = r"$\Delta C$ / W"
# Of eyes whose muscles have commands of their own.
ERRORS = {
    "vergence_error_deg": "horizontal (vergence)",
    "vertical_error_deg": "vertical",
    "cyclovergence_error_deg": "torsional (cyclovergence)",
}
# K17, section III: medians after 10^6 iterations, over all start errors, by model.
K17_ERROR_DEG = {"M": 0.07, "M_C": 0.176}
K17_C_PERCENT = {"M_C": 101.677}
_K17: dict[str, Any] = {"ls": (0, (4, 2, 1, 2)), "lw": 1.0}
# Fewer tests are points: a line between them would show a course that nobody has measured.
LEAST_JOINED = 5
# Intervals of two seeds are as wide as their axes.
_LEAST_SEEDS = 3
# Further groups of a model differ in lightness.
_COLOURS = {"M": (BLUE, "Blues"), "M_C": (VERMILION, "Oranges")}
_OTHER_COLOURS = ("black", "Greys")
_DARKEST, _LIGHTEST = 0.9, 0.4
_MARKERS = {"M": "o", "M_C": "D"}
# Shares of the width between the points of two groups.
_DODGE = 0.012
_LONGEST_TITLE_LINE = 44  # characters, where two panels share the width
# Errors below this share of a pixel need no room.
_LEAST_PX = 0.02


def colour_of(group: Group) -> str:
    """Return the colour of a group."""
    colour, shades = _COLOURS.get(group.model, _OTHER_COLOURS)
    i, n = group.rank
    if n == 1:
        return colour
    return to_hex(colormaps[shades](_DARKEST + (_LIGHTEST - _DARKEST) * i / (n - 1)))


def marker_of(group: Group) -> str:
    """Return the marker of the points of a group's model."""
    return _MARKERS.get(group.model, "s")


def offset_of(i: int, groups: Sequence[Group]) -> float:
    """Return how many points beside an iteration the i-th group's point stands."""
    return i - (len(groups) - 1) / 2


def final_errors_deg(trials: Trials, name: str = "vergence_error_deg") -> np.ndarray:
    """Return the absolute error of that name after a trial's last iteration, (n_trials,)."""
    return np.abs(trials.column(name)[:, -1])


def px_deg_of(groups: Sequence[Group]) -> float:
    """Return the visual angle of a pixel in the first group's last test, for lines at 1 px."""
    return groups[0].last_criteria.px_deg


def label_of(group: Group) -> str:
    """Return what a group is, with the numbers of its seeds and of their trials."""
    trials = f", {len(group.last_trials.trial):,} trials" if group.has_trials else ""
    return group.label + trials


def title_of(group: Group) -> str:
    """Return the title of a group's panel, of half a figure's width."""
    return textwrap.fill(label_of(group), _LONGEST_TITLE_LINE)


def draw_published(
    axes: Axes, groups: Sequence[Group], medians: Mapping[str, float]
) -> list[Line2D]:
    """Draw a line at K17's median of each model of the pair; return what stands for any."""
    models = {group.model for group in groups if group.is_of_pair} & {*medians}
    for model in models:
        axes.axhline(medians[model], color=_COLOURS[model][0], zorder=1, **_K17)
    return [Line2D([], [], color="black", label="median in K17", **_K17)] if models else []


def over_training(group: Group, values: Callable[[Trials], np.ndarray]) -> np.ndarray:
    """Return the quartiles (3, n) of a value of trials in each test of a group."""
    tests = [values(group.trials_at(iteration)) for iteration in group.iterations]
    return np.array([quartiles_of(of_test) for of_test in tests]).T


def of_seeds(group: Group, measure: Callable[[Summary], float | None]) -> np.ndarray:
    """Return a measure of each run and test of a group: (n_runs, n_tests)."""
    by_test = [[measure(test) for test in group.summaries_at(n)] for n in group.iterations]
    return np.array(by_test, dtype=np.float64).reshape(len(by_test), len(group.runs)).T


def quartiles_of(values: np.ndarray) -> np.ndarray:
    """Return the quartiles (3,) of those values that are known; NaN where none is."""
    known = values[~np.isnan(values)]
    return np.quantile(known, QUARTILES) if known.size else np.full(3, np.nan)


def group_handle(group: Group) -> Line2D:
    """Return what stands for a group in a legend."""
    return Line2D(
        [], [], color=colour_of(group), marker=marker_of(group), ms=4, label=label_of(group)
    )


def interval_handles(groups: Sequence[Group]) -> list[Line2D]:
    """Return what stands for intervals over seeds in a legend, where some group has them."""
    if all(len(group.runs) < _LEAST_SEEDS for group in groups):
        return []
    label = "95 % interval of the mean over seeds"
    return [Line2D([], [], color="black", ls="", marker="_", ms=8, label=label)]


def draw_quartiles(
    axes: Axes, quartiles: np.ndarray, group: Group, offset: float, seeds: np.ndarray
) -> None:
    """Draw quartiles (3, n) of each test over training: of many a line with a band, of few points.

    offset: how many points beside the iteration, where points are not joined. seeds: (n_runs, n)
    medians, of which the interval is drawn.
    """
    at = np.array(group.iterations, dtype=float)
    if len(at) < LEAST_JOINED:
        at = at + offset * _DODGE * group.common.n_iterations
        draw_bars(axes, at, quartiles, colour_of(group), marker=marker_of(group))
    else:
        draw_band(axes, at, quartiles, colour_of(group), marker=marker_of(group), ms=3)
    if len(seeds) >= _LEAST_SEEDS:
        mean, half = over_seeds(seeds)
        axes.errorbar(at, mean, half, fmt="none", ecolor=colour_of(group), lw=1.2, capsize=4)


def draw_band(axes: Axes, at: np.ndarray, quartiles: np.ndarray, colour: str, **style: Any) -> None:
    """Draw the median of quartiles (3, n) as a line, and a band from the lower to the upper."""
    lower, median, upper = quartiles
    axes.fill_between(at, lower, upper, color=colour, alpha=BAND_ALPHA, lw=0)
    axes.plot(at, median, color=colour, **style)


def draw_bars(axes: Axes, at: np.ndarray, quartiles: np.ndarray, colour: str, **style: Any) -> None:
    """Draw the medians of quartiles (3, n) as points, and bars from the lower to the upper."""
    lower, median, upper = quartiles
    axes.vlines(at, lower, upper, color=colour, lw=1.2)
    look: dict[str, Any] = {"marker": "o", "ms": 5} | style
    axes.plot(at, median, ls="", color=colour, **look)


def scale_errors(axes: Axes, px_deg: float, *, has_pixel: bool = True) -> None:
    """Draw errors in deg to a logarithmic scale, with a line at 1 px."""
    if scale_by_decades(axes):
        low, high = axes.get_ylim()
        if low < _LEAST_PX * px_deg < high:
            axes.set_ylim(_LEAST_PX * px_deg, high)
    label_decades(axes)
    if has_pixel:
        mark_level(axes, px_deg, "1 px")
