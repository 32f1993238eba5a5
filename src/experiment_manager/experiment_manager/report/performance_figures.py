"""K17's figures 2 and 3 and a run's learning curve, drawn from bags."""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from experiment_manager.measures.metrics import PX_DEG, REPORTED_ITERATIONS
from experiment_manager.measures.recorded_run import RecordedRun, RecordedTest
from experiment_manager.report.groups import Group, groups_of

FIGURES = "figures"
_DPI = 150

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
    run = RecordedRun(directory)
    with mpl.rc_context(STYLE):
        figure = learning_curve_figure(run)
        return save(figure, Path(directory) / FIGURES / "learning_curve.png")


def learning_curve_figure(run: RecordedRun) -> Figure:
    """Return the figure of one run: tests, and training behind them."""
    figure = new_figure(6.4, 4.2)
    axes = figure.add_subplot()
    curve = run.training_curve
    (line,) = axes.plot(
        curve.iteration, curve.quartiles_deg[1], color="0.6", lw=1, label="training, episode ends"
    )
    handles = [*_performance(axes, groups_of([run])), line]
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
        _draw_errors(lower, group)
    _mark_pixel(lower)
    lower.set(yscale="log", ylabel=r"$|\Delta\gamma|$ / deg", xlabel="training iterations")
    lower.yaxis.set_major_formatter(mpl.ticker.FormatStrFormatter("%g"))
    lower.yaxis.set_minor_formatter(mpl.ticker.NullFormatter())
    figure.legend(handles=handles, loc="outside lower center", ncols=2)
    return figure


def _performance(axes: Axes, groups: Sequence[Group]) -> list[Any]:
    """Draw median and quartiles of |error| and, on the right, median Delta C; return handles."""
    right = axes.twinx()
    right.spines["right"].set_visible(True)
    handles: list[Any] = []
    for group in groups:
        handles.append(_draw_errors(axes, group))
        delta_w = [float(np.median(_deltas_w(group.tests_at(at)))) for at in group.iterations]
        right.plot(group.iterations, delta_w, "--", marker=".", color=group.colour, lw=1.2)
    _mark_pixel(axes)
    axes.set(xlabel="training iterations", ylabel=r"$|\Delta\gamma|$ / deg", ylim=(0, None))
    axes.xaxis.set_major_formatter(mpl.ticker.EngFormatter(sep=""))
    right.set_ylabel(r"$\Delta C$ / W")
    # With 0 in sight the height of a line tells its size.
    right.axhline(0.0, alpha=0.0)
    right.margins(y=0.08)
    handles += [
        Line2D([], [], color="0.3", label=r"median $|\Delta\gamma|$ (left)"),
        Patch(color="0.3", alpha=0.2, lw=0, label="its quartiles"),
        Line2D([], [], color="0.3", ls="--", label=r"median $\Delta C$ (right)"),
    ]
    return handles


def _draw_errors(axes: Axes, group: Group) -> Line2D:
    at = group.iterations
    quartiles_deg = np.array([_quartiles(_errors_deg(group.tests_at(n))) for n in at]).reshape(
        -1, 3
    )
    (line,) = axes.plot(
        at, quartiles_deg[:, 1], color=group.colour, marker="o", ms=3, label=group.label
    )
    axes.fill_between(
        at, quartiles_deg[:, 0], quartiles_deg[:, 2], color=group.colour, alpha=0.2, lw=0
    )
    return line


def _mark_pixel(axes: Axes, *, outside: bool = False) -> None:
    """Draw a line at 1 px; outside: its name stands to the right of the axes."""
    axes.axhline(PX_DEG, color="0.5", lw=0.7, ls=":")
    axes.annotate(
        "1 px",
        (float(outside), PX_DEG),
        (3, 0 if outside else 1),
        va="center" if outside else "baseline",
        xycoords=("axes fraction", "data"),
        textcoords="offset points",
        color="0.4",
        fontsize=8,
    )


def _quartiles(values: np.ndarray) -> np.ndarray:
    quartiles: np.ndarray = np.quantile(values, (0.25, 0.5, 0.75))
    return quartiles


def _errors_deg(tests: Iterable[RecordedTest], iteration: int = -1) -> np.ndarray:
    errors = [np.abs(test.trials.vergence_error_deg[:, iteration]) for test in tests]
    return np.concatenate(errors)


def _deltas_w(tests: Iterable[RecordedTest]) -> np.ndarray:
    return np.concatenate([t.trials.delta_cost_w(t.trials.n_iterations) for t in tests])


def _cost_reductions(tests: Iterable[RecordedTest], iteration: int) -> np.ndarray:
    values = np.concatenate([test.trials.cost_reduction(iteration) for test in tests])
    return values[~np.isnan(values)]


def box_figure(groups: Sequence[Group]) -> Figure:
    """Return K17 Fig. 3: box plots after iterations 1, 2, 3 and 20 of the last test.

    Boxes are quartiles, whiskers reach the last value within 1.5 interquartile ranges; values
    beyond are not drawn.
    """
    figure = new_figure(5.2, 5.6)
    upper, lower = figure.subplots(2, 1, sharex=True)
    last = [group.tests_at(group.iterations[-1]) for group in groups]
    n_iterations = min(test.trials.n_iterations for tests in last for test in tests)
    shown = [k for k in REPORTED_ITERATIONS if k <= n_iterations]
    upper.axhspan(0, PX_DEG, color="0.85", lw=0)
    _mark_pixel(upper, outside=True)
    for level in (0, 100):
        lower.axhline(level, color="0.6", lw=0.7, ls=":")
    width = 0.7 / len(groups)
    for i, (group, tests) in enumerate(zip(groups, last, strict=True)):
        positions = np.arange(len(shown)) + (i - (len(groups) - 1) / 2) * width
        _boxes(upper, [_errors_deg(tests, k) for k in shown], positions, width, group.colour)
        percent = [100 * _cost_reductions(tests, k) for k in shown]
        _boxes(lower, percent, positions, width, group.colour)
    upper.set(ylabel=r"$|\Delta\gamma|$ / deg", ylim=(0, None))
    lower.set(ylabel="$c$ / %", xlabel="iteration of the trial")
    lower.set_xticks(range(len(shown)), [str(k) for k in shown])
    handles = [Patch(color=group.colour, alpha=0.6, label=group.label) for group in groups]
    figure.legend(handles=handles, loc="outside lower center", ncols=min(2, len(handles)))
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
