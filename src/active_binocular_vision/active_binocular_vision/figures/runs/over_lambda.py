"""What lambda does: accuracy and saved energy over lambda, and the trade-off."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.transforms import Bbox

from active_binocular_vision.figures.quartiles import (
    ERROR_LABEL,
    ERRORS,
    draw_bars,
    final_errors_deg,
    px_deg_of,
    quartiles_of,
    scale_errors,
)
from active_binocular_vision.figures.style import (
    BLUE,
    GREEN,
    GREY,
    SMALLEST_PT,
    VERMILION,
    WIDTH_IN,
    break_axis,
    legend_below,
    mark_level,
    new_figure,
    title_panels,
)
from active_binocular_vision.runs.groups import Group
from experiment_manager import Trials

_LEAST_LAMBDAS = 3
_LOOKS = ((VERMILION, "o"), (BLUE, "s"), (GREEN, "^"))
# Lambda 0 has a place on a logarithmic axis so many times below the least one.
_ZERO_BELOW = 3.0
_CLEARANCE_PX = 2.0
# Of the name of a point from it, the best first.
_OFFSETS_PT = tuple((dx, dy) for dy in (3.0, -3.0, 11.0, -11.0, 19.0, -19.0) for dx in (3.0, -3.0))

Values = Callable[[Trials], np.ndarray]


def _reductions_percent(trials: Trials) -> np.ndarray:
    reductions = trials.cost_reduction(trials.n_iterations)
    return 100 * reductions[~np.isnan(reductions)]


def over_lambda(groups: Sequence[Group]) -> list[Group]:
    """Return groups with trials that differ in lambda alone, by lambda; none for less than three.

    A group of M counts as lambda 0. Of several such families, the largest.
    """
    families: dict[object, dict[float, Group]] = {}
    for group in groups:
        if group.has_trials:
            family = families.setdefault((group.common.n_iterations, group.common.settings), {})
            # M_C with lambda 0, if it is there, is nearer to the others than M.
            if group.model != "M" or group.common.weight not in family:
                family[group.common.weight] = group
    largest = max(families.values(), key=len, default={})
    return [largest[w] for w in sorted(largest)] if len(largest) >= _LEAST_LAMBDAS else []


def lambda_figure(groups: Sequence[Group]) -> Figure:
    """Return error and saving of the last test over lambda, and error against metabolic rate.

    groups: of `over_lambda`. Median and quartiles over all trials of all seeds, whose numbers stand
    below the figure.
    """
    figure = new_figure(WIDTH_IN, 3.2)
    error, reduction, trade = figure.subplots(1, 3)
    px_deg = px_deg_of(groups)
    handles: list[Line2D] = []
    if all(group.is_of_pair for group in groups):
        _draw(error, groups, final_errors_deg)
        error.set_ylabel(ERROR_LABEL)
    else:
        handles = _draw_errors(error, groups)
    scale_errors(error, px_deg)
    _draw(reduction, groups, _reductions_percent)
    mark_level(reduction, 100.0, "all")
    reduction.set_ylabel("$c$ / %")
    _draw_trade(trade, groups)
    legend_below(figure, [*handles, _numbers(groups)])
    title_panels(
        (error, reduction, trade), ("accuracy", "energy saved", r"trade-off, by $\lambda$ in 1/W")
    )
    _name_points(figure, trade, [f"{group.common.weight:g}" for group in groups])
    return figure


def _numbers(groups: Sequence[Group]) -> Line2D:
    """Return what says how many seeds and trials a point stands for."""
    seeds, trials = (
        " to ".join(f"{n:,}" for n in sorted({min(of), max(of)}))
        for of in ([len(g.runs) for g in groups], [len(g.last_trials.trial) for g in groups])
    )
    return Line2D(
        [], [], ls="", label=f"n = {seeds} seed{'s' * (seeds != '1')}, {trials} trials each"
    )


def _draw_errors(axes: Axes, groups: Sequence[Group]) -> list[Line2D]:
    """Draw the errors about all axes, each with its colour; return what stands for them."""
    handles = []
    for (name, label), (colour, marker) in zip(ERRORS.items(), _LOOKS, strict=True):
        _draw(axes, groups, partial(final_errors_deg, name=name), colour, marker=marker)
        handles.append(Line2D([], [], color=colour, marker=marker, ms=4, label=label))
    axes.set_ylabel("|error| / deg")
    return handles


def _draw(
    axes: Axes,
    groups: Sequence[Group],
    values: Values,
    colour: str = VERMILION,
    **style: Any,
) -> None:
    weights = np.array([group.common.weight for group in groups])
    zero = weights[weights > 0].min() / _ZERO_BELOW
    quartiles = np.array([quartiles_of(values(g.last_trials)) for g in groups]).T
    places = np.maximum(weights, zero)
    draw_bars(axes, places, quartiles, colour, **style)
    is_positive = weights > 0
    axes.plot(places[is_positive], quartiles[1, is_positive], color=colour, lw=0.8)
    axes.set_xscale("log")
    axes.set_xlabel(r"$\lambda$ / (1/W)")
    steps = [step * 10.0**decade for decade in range(-6, 4) for step in (1, 3)]
    ticks = [step for step in steps if weights[is_positive].min() <= step <= 1.001 * weights.max()]
    is_there = [zero] if not is_positive.all() else []
    axes.set_xticks(is_there + ticks, ["0"] * len(is_there) + [f"{tick:g}" for tick in ticks])
    axes.xaxis.set_minor_locator(mpl.ticker.NullLocator())
    if is_there:
        break_axis(axes, zero * _ZERO_BELOW**0.5)


def _draw_trade(axes: Axes, groups: Sequence[Group]) -> None:
    """Draw the median error against the median metabolic rate, a point per lambda."""
    rate_w = [float(np.median(g.last_trials.metabolic_rate_w[:, -1])) for g in groups]
    error_deg = [float(np.median(final_errors_deg(g.last_trials))) for g in groups]
    axes.margins(x=0.12)
    axes.plot(rate_w, error_deg, color=VERMILION, marker="o", ms=4, lw=0.8)
    scale_errors(axes, px_deg_of(groups))
    axes.set(xlabel="metabolic rate $C$ / W", ylabel=ERROR_LABEL)


def _name_points(figure: Figure, axes: Axes, names: Sequence[str]) -> None:
    """Write a name beside each point of a line, where it covers neither the line nor a name.

    A thin line joins a name to its point where they are not next to each other.
    """
    figure.draw_without_rendering()  # so that the places are known
    line = axes.lines[0]
    course = line.get_transform().transform_path(line.get_path())
    boxes: list[Bbox] = []
    for name, point in zip(names, np.asarray(line.get_xydata()), strict=True):
        label = None
        for dx, dy in _OFFSETS_PT:
            if label is not None:
                label.remove()
            label = axes.annotate(
                name,
                point,
                (dx, dy),
                textcoords="offset points",
                ha="left" if dx > 0 else "right",
                va="bottom" if dy > 0 else "top",
                fontsize=SMALLEST_PT,
            )
            box = label.get_window_extent().padded(_CLEARANCE_PX)
            covers = course.intersects_bbox(box, filled=False) or box.count_overlaps(boxes)
            if not covers and box.x0 > axes.bbox.x0:
                break
        boxes.append(box)
        if abs(dy) > abs(_OFFSETS_PT[0][1]):
            join = {"arrowstyle": "-", "lw": 0.5, "color": GREY, "shrinkA": 0.0, "shrinkB": 2.0}
            axes.annotate("", point, (dx, dy), textcoords="offset points", arrowprops=join)
