"""K17's figures 2 and 3 and a run's learning curve."""

import math
import textwrap
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from experiment_manager.analysis.report.groups import Group, groups_of
from experiment_manager.analysis.report.reported_run import ReportedRun
from experiment_manager.measures.metrics import REPORTED_ITERATIONS
from experiment_manager.measures.results import Summary

FIGURES = "figures"
# One name for it, in figures as in tables.
ERROR_LABEL = "|vergence error| / deg"
_STEPS = (1.0, 2.0, 5.0)
# Of many groups lying upon each other, the bands are fainter.
_MANY_GROUPS = 4
_DPI = 150
# Inches of a figure's height that a legend may take.
_LEGEND_HEIGHT = 1.5
# Characters of a group's name in a legend or above a panel.
_LONGEST_LINE = 60

# For mpl.rc_context around whoever draws.
STYLE = {
    "font.size": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
}


def save(figure: Figure, path: Path) -> Path:
    """Write a figure as PNG and return the path; makes its directory."""
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=_DPI)
    return path


def new_figure(width: float, height: float) -> Figure:
    """Return an empty figure, in inches; no window system is involved."""
    return Figure(figsize=(width, height), layout="constrained")


def learning_curve(directory: Path) -> Path:
    """Draw how a run learned, from its bag, into figures/learning_curve.png; return that path.

    Tests as in K17 Fig. 2, and behind them the errors at the ends of training episodes.
    """
    run = ReportedRun(directory)
    with mpl.rc_context(STYLE):
        figure = learning_curve_figure(run)
        return save(figure, Path(directory) / FIGURES / "learning_curve.png")


def learning_curve_figure(run: ReportedRun) -> Figure:
    """Return the figure of one run: tests, and training behind them if its bag is there."""
    figure = new_figure(6.4, 4.2)
    axes = figure.add_subplot()
    handles: list[Any] = []
    if run.recorded is not None:
        curve = run.recorded.measured.training_curve
        (line,) = axes.plot(curve.iteration, curve.quartiles_deg[1], color="0.6", lw=1)
        line.set_label("training, episode ends")
        handles.append(line)
    handles = [*_performance(axes, groups_of([run])), *handles]
    axes.set_title(f"{run.name}: model {run.model}, seed {run.seed}", loc="left", fontsize=9)
    figure.legend(handles=handles, loc="outside lower center", ncols=3)
    return figure


def performance_figure(groups: Sequence[Group]) -> Figure:
    """Return K17 Fig. 2: |vergence error| and Delta C of the tests over training.

    Below it the same errors on a logarithmic axis, where those after learning can be told apart.
    """
    figure = new_figure(6.4, 6.2)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    handles = _performance(upper, groups)
    upper.set_xlabel("")
    for group in groups:
        _draw_errors(lower, group, len(groups))
    mark_pixel(lower, px_deg_of(groups))
    lower.set(yscale="log", ylabel=ERROR_LABEL, xlabel="training iterations")
    label_decades(lower)
    add_legend(figure, handles)
    return figure


def add_legend(figure: Figure, handles: Sequence[Any]) -> None:
    """Put a legend below a figure, in two columns if they have room, otherwise in one.

    The figure grows by what a long one needs.
    """
    # Measured without the layout, which would find no room for the axes above a long legend.
    renderer = FigureCanvasAgg(figure).get_renderer()
    for n_columns in (2, 1):
        legend = figure.legend(handles=handles, loc="outside lower center", ncols=n_columns)
        if n_columns == 1 or legend.get_window_extent(renderer).width <= figure.bbox.width:
            break
        legend.remove()
    for text in legend.get_texts():
        text.set_text(textwrap.fill(text.get_text(), _LONGEST_LINE))
    needed = legend.get_window_extent(renderer).height / figure.dpi
    figure.set_figheight(figure.get_figheight() + max(0.0, needed - _LEGEND_HEIGHT))


def label_decades(axes: Axes) -> None:
    """Let a logarithmic axis begin and end at 1, 2 or 5 times a power of ten: labelled ticks."""
    low, high = axes.get_ylim()
    reach = range(math.floor(math.log10(low)) - 1, math.ceil(math.log10(high)) + 2)
    steps = [step * 10.0**decade for decade in reach for step in _STEPS]
    below = max(step for step in steps if step <= low)
    above = min(step for step in steps if step >= high)
    axes.set_ylim(below, above)
    axes.yaxis.set_major_locator(mpl.ticker.FixedLocator([s for s in steps if below <= s <= above]))
    axes.yaxis.set_major_formatter(mpl.ticker.FormatStrFormatter("%g"))
    axes.yaxis.set_minor_formatter(mpl.ticker.NullFormatter())


def _performance(axes: Axes, groups: Sequence[Group]) -> list[Any]:
    """Draw median and quartiles of |error| and, on the right, median Delta C; return handles."""
    right = axes.twinx()
    right.spines["right"].set_visible(True)
    handles: list[Any] = []
    for group in groups:
        handles.append(_draw_errors(axes, group, len(groups)))
        _draw_deltas(right, group)
    mark_pixel(axes, px_deg_of(groups))
    axes.set(xlabel="training iterations", ylabel=ERROR_LABEL, ylim=(0, None))
    axes.xaxis.set_major_formatter(mpl.ticker.EngFormatter(sep=""))
    right.set_ylabel(r"$\Delta C$ / W")
    # With 0 in sight the height of a line tells its size.
    right.axhline(0.0, alpha=0.0)
    right.margins(y=0.08)
    handles.append(Line2D([], [], color="0.3", label="median |vergence error| (left)"))
    if any(group.has_trials for group in groups):
        handles.append(Patch(color="0.3", alpha=0.2, lw=0, label="its quartiles"))
    handles.append(Line2D([], [], color="0.3", ls="--", label=r"median $\Delta C$ (right)"))
    if any(len(group.runs) > 1 for group in groups):
        handles.append(Line2D([], [], color="0.3", lw=0.6, alpha=0.6, label="each seed"))
    return handles


def _draw_errors(axes: Axes, group: Group, n_groups: int) -> Line2D:
    """Draw the pooled median with quartiles, and each seed's median thin behind it.

    Without trials the line is the median over seeds, without quartiles.
    """
    at = group.iterations
    seeds_deg = _of_seeds(group, lambda test: test.median_abs_vergence_error_deg)
    median_deg = np.median(seeds_deg, axis=0)
    if group.has_trials:
        errors_deg = [np.abs(group.trials_at(n).vergence_error_deg[:, -1]) for n in at]
        lower_deg, median_deg, upper_deg = np.quantile(errors_deg, (0.25, 0.5, 0.75), axis=1)
        alpha = 0.2 if n_groups <= _MANY_GROUPS else 0.08
        axes.fill_between(at, lower_deg, upper_deg, color=group.colour, alpha=alpha, lw=0)
    (line,) = axes.plot(at, median_deg, color=group.colour, marker="o", ms=3, label=group.label)
    _draw_seeds(axes, at, seeds_deg, group.colour, "-")
    return line


def _draw_deltas(axes: Axes, group: Group) -> None:
    at = group.iterations
    seeds_w = _of_seeds(group, lambda test: test.median_delta_cost_w)
    median_w = np.median(seeds_w, axis=0)
    if group.has_trials:
        tests = [group.trials_at(n) for n in at]
        median_w = np.array([np.median(test.delta_cost_w(test.n_iterations)) for test in tests])
    axes.plot(at, median_w, "--", marker=".", color=group.colour, lw=1.2)
    _draw_seeds(axes, at, seeds_w, group.colour, "--")


def _of_seeds(group: Group, measure: Callable[[Summary], float | None]) -> np.ndarray:
    """Return a measure of each run and test: (n_runs, n_tests)."""
    by_test = [[measure(test) for test in group.summaries_at(n)] for n in group.iterations]
    return np.array(by_test, dtype=np.float64).reshape(len(by_test), len(group.runs)).T


def _draw_seeds(
    axes: Axes, at: Sequence[int], values: np.ndarray, colour: str, linestyle: str
) -> None:
    for of_seed in values if len(values) > 1 else ():
        axes.plot(at, of_seed, color=colour, lw=0.6, alpha=0.6, ls=linestyle, zorder=1)


def px_deg_of(groups: Sequence[Group]) -> float:
    """Return the visual angle of a pixel in the first group's last test, for lines at 1 px."""
    return groups[0].last_criteria.px_deg


def mark_pixel(axes: Axes, px_deg: float, *, outside: bool = False) -> None:
    """Draw a line at 1 px; outside: its name stands to the right of the axes."""
    axes.axhline(px_deg, color="0.5", lw=0.7, ls=":")
    axes.annotate(
        "1 px",
        (float(outside), px_deg),
        (3, 0 if outside else 1),
        va="center" if outside else "baseline",
        xycoords=("axes fraction", "data"),
        textcoords="offset points",
        color="0.4",
        fontsize=8,
    )


def box_figure(groups: Sequence[Group]) -> Figure:
    """Return K17 Fig. 3: box plots after iterations 1, 2, 3 and 20 of the last test.

    groups: with trials. Boxes are quartiles, whiskers reach the last value within 1.5 interquartile
    ranges; values beyond are not drawn.
    """
    figure = new_figure(5.2, 5.6)
    upper, lower = figure.subplots(2, 1, sharex=True)
    last = [group.last_trials for group in groups]
    n_iterations = min(trials.n_iterations for trials in last)
    shown = [k for k in REPORTED_ITERATIONS if k <= n_iterations]
    px_deg = px_deg_of(groups)
    upper.axhspan(0, px_deg, color="0.85", lw=0)
    mark_pixel(upper, px_deg, outside=True)
    for level in (0, 100):
        lower.axhline(level, color="0.6", lw=0.7, ls=":")
    width = 0.7 / len(groups)
    for i, (group, trials) in enumerate(zip(groups, last, strict=True)):
        positions = np.arange(len(shown)) + (i - (len(groups) - 1) / 2) * width
        errors_deg = [np.abs(trials.vergence_error_deg[:, k]) for k in shown]
        _boxes(upper, errors_deg, positions, width, group.colour)
        reductions = [100 * trials.cost_reduction(k) for k in shown]
        _boxes(lower, [c[~np.isnan(c)] for c in reductions], positions, width, group.colour)
    upper.set(ylabel=ERROR_LABEL, ylim=(0, None))
    lower.set(ylabel="$c$ / %", xlabel="iteration of the trial")
    lower.set_xticks(range(len(shown)), [str(k) for k in shown])
    handles = [Patch(color=group.colour, alpha=0.6, label=group.label) for group in groups]
    add_legend(figure, handles)
    return figure


def _boxes(
    axes: Axes, values: Sequence[np.ndarray], positions: np.ndarray, width: float, colour: str
) -> None:
    axes.boxplot(
        list(values),
        positions=list(positions),
        widths=0.85 * width,
        showfliers=False,
        patch_artist=True,
        boxprops={"facecolor": colour, "alpha": 0.6, "lw": 0.8},
        medianprops={"color": "black", "lw": 1.4},
        whiskerprops={"color": colour},
        capprops={"color": colour},
        manage_ticks=False,
    )
