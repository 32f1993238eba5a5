"""K17's figures 2 and 3 and a run's learning curve."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from experiment_manager.analysis.recorded_run import TrainingCurve
from experiment_manager.analysis.report.groups import Group, groups_of
from experiment_manager.analysis.report.reported_run import ReportedRun
from experiment_manager.measures.metrics import REPORTED_ITERATIONS
from experiment_manager.measures.results import Summary
from experiment_manager.measures.trials import Trials
from lockstep.figures import (
    BAND_ALPHA,
    GREY,
    STYLE,
    label_decades,
    legend_below,
    mark_level,
    new_figure,
    save,
    title_panels,
)

FIGURES = "figures"
# One name for each, in figures as in tables.
ERROR_LABEL = "|vergence error| / deg"
DELTA_LABEL = r"$\Delta C$ / W"
QUARTILES = (0.25, 0.5, 0.75)
# Fewer tests are points: a line between them would show a course that nobody has measured.
LEAST_JOINED = 5
# Shares of the width between the points of two groups.
_DODGE = 0.012
# Whiskers of boxes are these percentiles.
_WHISKERS = (5, 95)
# Errors below this share of a pixel need no room.
_LEAST_PX = 0.02


def learning_curve(directory: Path) -> Path:
    """Draw how a run learned, from its bag, into figures/learning_curve.png; return that path."""
    run = ReportedRun(directory)
    with mpl.rc_context(STYLE):
        return save(learning_curve_figure(run), Path(directory) / FIGURES / "learning_curve.png")


def learning_curve_figure(run: ReportedRun) -> Figure:
    """Return the figure of one run: its tests, and its training episodes if its bag is there."""
    training = run.recorded.measured.training_curve if run.recorded is not None else None
    return performance_figure(groups_of([run]), training)


def performance_figure(groups: Sequence[Group], training: TrainingCurve | None = None) -> Figure:
    """Return K17 Fig. 2: |vergence error| and Delta C of the tests over training.

    training: drawn behind the tests. Median and quartiles; without trials the medians alone.
    """
    figure = new_figure(7.0, 5.2)
    errors, deltas = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    handles: list[Any] = [_group_handle(group) for group in groups]
    if training is not None:
        for axes, quartiles in ((errors, training.quartiles_deg), (deltas, training.quartiles_w)):
            draw_band(axes, training.iteration, quartiles, GREY, lw=1.0)
        handles.append(Line2D([], [], color=GREY, lw=1.0, label="ends of training episodes"))
    for i, group in enumerate(groups):
        place = place_of(i, groups)
        _draw_tests(
            errors, group, final_errors_deg, lambda t: t.median_abs_vergence_error_deg, place
        )
        _draw_tests(deltas, group, _final_deltas_w, lambda t: t.median_delta_cost_w, place)
    scale_errors(errors, px_deg_of(groups))
    errors.set_ylabel(ERROR_LABEL)
    mark_level(deltas, 0.0, "")
    if min(group.iterations[0] for group in groups) > 0:
        deltas.set_xlim(left=0.0)
    deltas.set(xlabel="training iterations", ylabel=DELTA_LABEL)
    deltas.xaxis.set_major_formatter(mpl.ticker.EngFormatter(sep=""))
    title_panels((errors, deltas), ("vergence error", "metabolic rate above the least possible"))
    legend_below(figure, handles)
    return figure


def place_of(i: int, groups: Sequence[Group]) -> float:
    """Return how many points beside an iteration the i-th group's point stands."""
    return i - (len(groups) - 1) / 2


def final_errors_deg(trials: Trials) -> np.ndarray:
    """Return |vergence error| after a trial's last iteration, (n_trials,)."""
    errors_deg: np.ndarray = np.abs(trials.vergence_error_deg[:, -1])
    return errors_deg


def _final_deltas_w(trials: Trials) -> np.ndarray:
    return trials.delta_cost_w(trials.n_iterations)


def _group_handle(group: Group) -> Line2D:
    return Line2D([], [], color=group.colour, marker=group.marker, ms=4, label=group.label)


def _draw_tests(
    axes: Axes,
    group: Group,
    values: Callable[[Trials], np.ndarray],
    measure: Callable[[Summary], float | None],
    place: float,
) -> None:
    """Draw a measure over the tests: pooled median and quartiles, and each seed's median.

    Without trials the medians over seeds, without quartiles.
    """
    seeds = _of_seeds(group, measure)
    quartiles = np.tile(np.median(seeds, axis=0), (3, 1))
    if group.has_trials:
        tests = [values(group.trials_at(n)) for n in group.iterations]
        quartiles = np.array([np.quantile(of_test, QUARTILES) for of_test in tests]).T
    at = np.array(group.iterations, dtype=float)
    draw_quartiles(axes, at, quartiles, group, place)
    for of_seed in seeds if len(seeds) > 1 and len(at) >= LEAST_JOINED else ():
        axes.plot(at, of_seed, color=group.colour, lw=0.6, alpha=0.7, zorder=1)


def draw_quartiles(
    axes: Axes, at: np.ndarray, quartiles: np.ndarray, group: Group, place: float
) -> None:
    """Draw quartiles (3, n) over training: of many tests a line with a band, of few points.

    place: how many points beside the iteration, where points are not joined.
    """
    if len(at) < LEAST_JOINED:
        beside = at + place * _DODGE * group.common.n_iterations
        draw_bars(axes, beside, quartiles, group.colour, marker=group.marker)
    else:
        draw_band(axes, at, quartiles, group.colour, marker=group.marker, ms=3)


def draw_band(
    axes: Axes, at: np.ndarray, quartiles: np.ndarray, colour: str, **style: Any
) -> Line2D:
    """Draw the median of quartiles (3, n) as a line, and a band from the lower to the upper."""
    lower, median, upper = quartiles
    axes.fill_between(at, lower, upper, color=colour, alpha=BAND_ALPHA, lw=0)
    return axes.plot(at, median, color=colour, **style)[0]


def draw_bars(
    axes: Axes, at: np.ndarray, quartiles: np.ndarray, colour: str, **style: Any
) -> Line2D:
    """Draw the medians of quartiles (3, n) as points, and bars from the lower to the upper."""
    lower, median, upper = quartiles
    axes.vlines(at, lower, upper, color=colour, lw=1.2)
    look: dict[str, Any] = {"marker": "o", "ms": 5} | style
    return axes.plot(at, median, ls="", color=colour, **look)[0]


def _of_seeds(group: Group, measure: Callable[[Summary], float | None]) -> np.ndarray:
    """Return a measure of each run and test: (n_runs, n_tests)."""
    by_test = [[measure(test) for test in group.summaries_at(n)] for n in group.iterations]
    return np.array(by_test, dtype=np.float64).reshape(len(by_test), len(group.runs)).T


def px_deg_of(groups: Sequence[Group]) -> float:
    """Return the visual angle of a pixel in the first group's last test, for lines at 1 px."""
    return groups[0].last_criteria.px_deg


def scale_errors(axes: Axes, px_deg: float, *, has_pixel: bool = True) -> None:
    """Draw errors in deg to a logarithmic scale, with a line at 1 px."""
    axes.set_yscale("log")
    low, high = axes.get_ylim()
    if low < _LEAST_PX * px_deg < high:
        axes.set_ylim(_LEAST_PX * px_deg, high)
    label_decades(axes)
    if has_pixel:
        mark_level(axes, px_deg, "1 px")


def box_figure(groups: Sequence[Group]) -> Figure:
    """Return K17 Fig. 3: box plots after iterations 1, 2, 3 and 20 of the last test.

    groups: with trials. Boxes are quartiles, whiskers the 5th and the 95th percentile.
    """
    figure = new_figure(5.6, 5.6)
    errors, reductions = figure.subplots(2, 1, sharex=True)
    last = [group.last_trials for group in groups]
    shown = [k for k in REPORTED_ITERATIONS if k <= min(trials.n_iterations for trials in last)]
    # The last iteration is far from the others.
    places = np.arange(len(shown)) + 0.5 * (np.diff(shown, prepend=0) > 1)
    width = 0.7 / len(groups)
    for i, (group, trials) in enumerate(zip(groups, last, strict=True)):
        at = places + place_of(i, groups) * width
        errors_deg = [np.abs(trials.vergence_error_deg[:, k]) for k in shown]
        _draw_boxes(errors, errors_deg, at, width, group.colour)
        shares = [100 * trials.cost_reduction(k) for k in shown]
        _draw_boxes(reductions, [c[~np.isnan(c)] for c in shares], at, width, group.colour)
    scale_errors(errors, px_deg_of(groups))
    errors.set_ylabel(ERROR_LABEL)
    mark_level(reductions, 0.0, "as at the start")
    mark_level(reductions, 100.0, "least possible")
    reductions.set(ylabel="$c$ / %", xlabel="iteration of the trial")
    reductions.set_xticks(places, [str(k) for k in shown])
    title_panels((errors, reductions), ("vergence error", "share of the possible saving"))
    handles = [Patch(color=group.colour, alpha=0.6, label=group.label) for group in groups]
    legend_below(figure, handles)
    return figure


def _draw_boxes(
    axes: Axes, values: Sequence[np.ndarray], positions: np.ndarray, width: float, colour: str
) -> None:
    axes.boxplot(
        list(values),
        positions=list(positions),
        widths=0.85 * width,
        whis=_WHISKERS,
        showfliers=False,
        patch_artist=True,
        boxprops={"facecolor": colour, "alpha": 0.6, "lw": 0.8},
        medianprops={"color": "black", "lw": 1.4},
        whiskerprops={"color": colour},
        capprops={"color": colour},
        manage_ticks=False,
    )
