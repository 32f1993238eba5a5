"""What a price on energy does: vergence, saved energy and watts over lambda, and their trade."""

from collections.abc import Callable, Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from experiment_manager.analysis.report.groups import Group
from experiment_manager.analysis.report.performance_figures import (
    ERROR_LABEL,
    new_figure,
    px_deg_of,
)
from experiment_manager.measures.trials import Trials

_LEAST_PRICES = 3
# Prices below this are drawn to a linear scale, so that 0 has a place.
_LINEAR_UP_TO = 0.01

Values = Callable[[Trials], np.ndarray]


def _errors_deg(trials: Trials) -> np.ndarray:
    errors_deg: np.ndarray = np.abs(trials.vergence_error_deg[:, -1])
    return errors_deg


def _reductions_percent(trials: Trials) -> np.ndarray:
    reductions = trials.cost_reduction(trials.n_iterations)
    defined: np.ndarray = 100 * reductions[~np.isnan(reductions)]
    return defined


def _deltas_w(trials: Trials) -> np.ndarray:
    return trials.delta_cost_w(trials.n_iterations)


def _rates_w(trials: Trials) -> np.ndarray:
    rates_w: np.ndarray = trials.metabolic_rate_w[:, -1]
    return rates_w


def over_prices(groups: Sequence[Group]) -> list[Group]:
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
    return [largest[w] for w in sorted(largest)] if len(largest) >= _LEAST_PRICES else []


def price_figure(groups: Sequence[Group]) -> Figure:
    """Return measures of the last test over lambda, and the error against the metabolic rate.

    groups: of `over_prices`. Median and quartiles over all trials of all seeds, each seed a dot.
    """
    figure = new_figure(9.6, 5.4)
    (error, reduction, delta), (rate, trade, rest) = figure.subplots(2, 3)
    _draw(error, groups, _errors_deg, ERROR_LABEL)
    px_deg = px_deg_of(groups)
    if error.get_ylim()[1] > px_deg:
        error.axhline(px_deg, color="0.5", lw=0.7, ls=":", label="1 px")
    _draw(reduction, groups, _reductions_percent, "$c$ / %")
    _draw(delta, groups, _deltas_w, r"$\Delta C$ / W")
    _draw(rate, groups, _rates_w, "metabolic rate $C$ / W")
    _draw_trade(trade, groups)
    rest.set_axis_off()
    handles, labels = error.get_legend_handles_labels()
    rest.legend(handles, labels, loc="center left")
    return figure


def _draw(axes: Axes, groups: Sequence[Group], values: Values, label: str) -> None:
    weights = [group.common.weight for group in groups]
    quartiles = np.array(
        [np.quantile(values(group.last_trials), (0.25, 0.5, 0.75)) for group in groups]
    )
    axes.plot(
        weights, quartiles[:, 1], color="#2b8a3e", marker="o", ms=4, label="median, all trials"
    )
    axes.fill_between(
        weights,
        quartiles[:, 0],
        quartiles[:, 2],
        color="#2b8a3e",
        alpha=0.2,
        lw=0,
        label="quartiles",
    )
    for i, group in enumerate(groups):
        medians = [float(np.median(values(trials))) for trials in _last_of_seeds(group)]
        if len(medians) > 1:
            name = "each seed" if i == 0 else None
            axes.plot([weights[i]] * len(medians), medians, ".", color="0.3", ms=4, label=name)
    axes.set_xscale("symlog", linthresh=_LINEAR_UP_TO, linscale=0.6)
    axes.set_xticks(weights, [f"{weight:g}" for weight in weights], fontsize=7, rotation=45)
    axes.xaxis.set_minor_locator(mpl.ticker.NullLocator())
    axes.set(xlabel=r"$\lambda$ / per W", ylabel=label)
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, 0.0), high)


def _draw_trade(axes: Axes, groups: Sequence[Group]) -> None:
    """Draw the median error against the median metabolic rate, a point per lambda."""
    rate_w = [float(np.median(_rates_w(group.last_trials))) for group in groups]
    error_deg = [float(np.median(_errors_deg(group.last_trials))) for group in groups]
    axes.plot(rate_w, error_deg, color="#2b8a3e", marker="o", ms=4)
    for i, group in enumerate(groups):
        # By turns above and below: where energy is nearly all saved, points are close.
        axes.annotate(
            f"{group.common.weight:g}",
            (rate_w[i], error_deg[i]),
            (5, (-9, 4)[i % 2]),
            textcoords="offset points",
            fontsize=7,
        )
        for trials in _last_of_seeds(group) if len(group.runs) > 1 else ():
            medians = (np.median(_rates_w(trials)), np.median(_errors_deg(trials)))
            axes.plot(*medians, ".", color="0.3", ms=4)
    axes.set(xlabel="metabolic rate $C$ / W", ylabel=ERROR_LABEL, yscale="log")
    axes.yaxis.set_major_locator(mpl.ticker.LogLocator(subs=(1, 2, 5)))
    axes.yaxis.set_minor_locator(mpl.ticker.NullLocator())
    axes.yaxis.set_major_formatter(mpl.ticker.FormatStrFormatter("%g"))
    axes.margins(y=0.15)
    axes.set_title(r"accuracy against watts, by $\lambda$", fontsize=9)


def _last_of_seeds(group: Group) -> list[Trials]:
    return [run.trials[group.iterations[-1]] for run in group.runs]
