"""Figures of conditions: learning, landscape of the reward, tuning; a panel or a row for each."""

import textwrap
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from active_binocular_vision.examinations.code.landscape import depth_of
from active_binocular_vision.figures.conditions.sheet import n_seeds
from active_binocular_vision.figures.quartiles import ERROR_LABEL, scale_errors
from active_binocular_vision.figures.style import (
    BLUE,
    GREY,
    LIGHT_GREY,
    SMALLEST_PT,
    WIDTH_IN,
    legend_below,
    new_figure,
    panel_grid,
    title_panels,
)
from active_binocular_vision.learners.basis_functions import (
    BINOCULARITY_EDGES,
    ORIENTATION_STEP_DEG,
)
from active_binocular_vision.runs.conditions import Condition
from active_binocular_vision.runs.examined_run import END, ExaminedRun
from lockstep.scales import PATCH_SIZE_PX, SCALES

_N_COLUMNS = 4
_LARGEST_DISPARITY_DEG = 4.0
_N_DISPARITY_BINS = 33  # odd: one is centred on 0
_LONGEST_ROW_NAME = 15  # characters of a line
_YARDSTICK = "normal"
# A row of the table of an examination.
Row = Mapping[str, Any]


def curves_figure(conditions: Sequence[Condition]) -> Figure:
    """Return the median |vergence error| of each test over training, a line for each seed.

    A vertical line stands where the condition's schedule changes the plant.
    """
    figure, panels = panel_grid(len(conditions), _N_COLUMNS, 1.7, share=True)
    for axes, condition in zip(panels, conditions, strict=True):
        for run in _yardstick(conditions, condition):
            _draw_curve(axes, run, GREY, lw=0.8)
        for run in condition.runs:
            _draw_curve(axes, run, BLUE, marker="o", ms=2.5)
        for at in condition.runs[0].changed_at:
            axes.axvline(at, color="black", lw=0.8, ls="--")
        axes.xaxis.set_major_formatter(lambda value, _: f"{value / 1000:g}k" if value else "0")
    for axes in panels:
        scale_errors(axes, conditions[0].runs[0].px_deg)
    handles = [
        Line2D([], [], color=BLUE, marker="o", ms=2.5, label="the condition, each seed"),
        Line2D([], [], color=GREY, lw=0.8, label="normal, each seed"),
    ]
    if any(condition.runs[0].changed_at for condition in conditions):
        handles.append(
            Line2D([], [], color="black", lw=0.8, ls="--", label="change of the eyes or input")
        )
    _label(panels, conditions, "training iterations", ERROR_LABEL)
    legend_below(figure, handles)
    return figure


def landscapes_figure(conditions: Sequence[Condition]) -> Figure | None:
    """Return the reconstruction error over the vergence error, as a share of its mean.

    Mean over seeds, at the end. The depth stands in the corner. None without any landscape.
    """
    shown = [of for of in conditions if landscapes(of.runs)]
    if not shown:
        return None
    figure, panels = panel_grid(len(shown), _N_COLUMNS, 1.7, share=True)
    for axes, condition in zip(panels, shown, strict=True):
        if yardstick := landscapes(_yardstick(conditions, condition)):
            _draw_landscape(axes, yardstick, GREY, 0.8)
        of_seeds = landscapes(condition.runs)
        _draw_landscape(axes, of_seeds, BLUE, 1.6)
        axes.axvline(0.0, color=GREY, lw=0.8, ls=":", zorder=1)
        depth = np.mean([depth_of(total) for _, total in of_seeds])
        axes.text(0.03, 0.05, f"depth {depth:.2f}", transform=axes.transAxes, fontsize=SMALLEST_PT)
    panels[0].set_ylim(0.0, None)
    handles = [
        Line2D([], [], color=BLUE, label=f"the condition, mean of {n_seeds(shown)}"),
        Line2D([], [], color=GREY, lw=0.8, label="normal"),
    ]
    _label(panels, shown, "vergence error / deg", "$E$ / mean $E$")
    legend_below(figure, handles)
    return figure


def landscapes(runs: Sequence[ExaminedRun]) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return vergence errors (n,) in deg and reconstruction errors (n,) of runs that have them.

    Of both scales together, at the end; nan where the eyes do not reach the vergence.
    """
    tables = [rows for run in runs if (rows := run.table(END, "landscape", "errors"))]
    names = "vergence_error_deg", *(f"reconstruction_error_{scale}" for scale in SCALES)
    columns = [np.array([[row[n] for n in names] for row in of], np.float64).T for of in tables]
    return [(errors_deg, coarse + fine) for errors_deg, coarse, fine in columns]


def samples_figure(conditions: Sequence[Condition]) -> Figure | None:
    """Return basis functions of each condition's first run, from the best to the worst Gabor fit.

    Left eye above right eye. None where no run has any.
    """
    known = [(of, [row["samples"] for row in _tunings(of)[0]]) for of in conditions if _tunings(of)]
    shown = [(of.name, np.array(samples)) for of, samples in known if all(samples)]
    if not shown:
        return None
    figure = new_figure(WIDTH_IN, 0.7 * len(shown) + 0.5)
    panels = figure.subplots(len(shown), len(SCALES), squeeze=False)
    for row, (label, samples) in zip(panels, shown, strict=True):
        for axes, of_scale in zip(row, samples, strict=True):
            axes.imshow(_strip(of_scale), cmap="gray", vmin=-1, vmax=1)
            axes.set(xticks=[], yticks=[(PATCH_SIZE_PX - 1) / 2, (3 * PATCH_SIZE_PX - 1) / 2])
            axes.set_yticklabels(["L", "R"], fontsize=SMALLEST_PT)
            axes.tick_params(length=0)
            axes.spines[:].set_visible(False)
        _name_row(row[0], label)
    for axes, scale in zip(panels[-1], SCALES, strict=True):
        n = shown[0][1].shape[1]
        axes.set_xlabel(
            f"{scale} scale: best to worst Gabor fit,\nn = {n} of one seed, evenly spaced"
        )
    return figure


def histograms_figure(conditions: Sequence[Condition]) -> Figure | None:
    """Return orientation, binocularity and preferred disparity, coarse and fine, all seeds pooled.

    Shares of the basis functions that have the property; their numbers stand above each panel. None
    without any tuning.
    """
    shown = [of for of in conditions if _tunings(of)]
    if not shown:
        return None
    columns: tuple[tuple[str, np.ndarray, Callable[[Row], np.ndarray]], ...] = (
        (
            "orientation / deg\n0: horizontal, 90: vertical",
            ORIENTATION_STEP_DEG * (np.arange(9) - 0.5),
            lambda row: np.array(row["orientation_counts"]),
        ),
        (
            "binocularity $(R-L)/(R+L)$\n-1: left eye alone, 1: right eye alone",
            BINOCULARITY_EDGES,
            lambda row: np.array(row["binocularity_counts"]),
        ),
        ("preferred disparity / deg", _DISPARITY_EDGES_DEG, _disparity_counts),
    )
    figure = new_figure(WIDTH_IN, 0.85 * len(shown) + 0.9)
    panels = figure.subplots(len(shown), len(columns), sharex="col", sharey="col", squeeze=False)
    for row, condition in zip(panels, shown, strict=True):
        for axes, (_, edges, counts) in zip(row, columns, strict=True):
            by_scale = zip(*_tunings(condition), strict=True)
            pooled = [np.sum([counts(of) for of in of_scale], axis=0) for of_scale in by_scale]
            _draw_shares(axes, edges, pooled)
        _name_row(row[0], condition.name)
    for axes, (name, edges, _) in zip(panels[-1], columns, strict=True):
        axes.set(xlabel=name, xlim=(edges[0], edges[-1]))
    panels[0, 0].set_xticks([0, 45, 90, 135])
    handles = [
        Patch(color=LIGHT_GREY, label=f"coarse scale, functions of {n_seeds(shown)}"),
        Line2D([], [], color=BLUE, lw=1.0, label="fine scale"),
    ]
    figure.supylabel("share of the functions / %", fontsize=9)
    for axes in panels[:, -1]:  # most prefer no disparity; the others must show, too
        axes.set_yscale("function", functions=(np.sqrt, np.square))
        axes.set_yticks([0, 10, 50, 100])
    legend_below(figure, handles)
    return figure


_DISPARITY_EDGES_DEG = np.linspace(
    -_LARGEST_DISPARITY_DEG, _LARGEST_DISPARITY_DEG, _N_DISPARITY_BINS + 1
)


def _tunings(condition: Condition) -> list[Sequence[Row]]:
    """Return the rows of coarse and fine of each seed whose basis functions were examined."""
    return [rows[: len(SCALES)] for rows in condition.tables("tuning", "scales")]


def _disparity_counts(row: Row) -> np.ndarray:
    return np.histogram(row["preferred_disparities_deg"], _DISPARITY_EDGES_DEG)[0]


def _draw_shares(axes: Axes, edges: np.ndarray, counts: Sequence[np.ndarray]) -> None:
    """Draw shares in percent; counts: (n_bins,) of the coarse and of the fine scale."""
    coarse, fine = (100.0 * of_scale / max(of_scale.sum(), 1) for of_scale in counts)
    axes.stairs(coarse, edges, fill=True, color=LIGHT_GREY)
    axes.stairs(fine, edges, color=BLUE, lw=1.0)
    numbers = " and ".join(str(of_scale.sum()) for of_scale in counts)
    axes.set_title(f"n = {numbers}", loc="right", fontsize=SMALLEST_PT)


def _yardstick(conditions: Sequence[Condition], condition: Condition) -> list[ExaminedRun]:
    """Return the runs of normal eyes and a condition's model, for all other panels than theirs."""
    first = condition.runs[0]
    if first.condition == _YARDSTICK:
        return []
    return [
        run
        for other in conditions
        for run in other.runs
        if run.condition == _YARDSTICK and run.model == first.model
    ]


def _draw_curve(axes: Axes, run: ExaminedRun, colour: str, **style: Any) -> None:
    iterations, errors_deg = np.array(run.curve, np.float64).T
    axes.plot(iterations, errors_deg, color=colour, **style)


def _draw_landscape(
    axes: Axes, of_seeds: Sequence[tuple[np.ndarray, np.ndarray]], colour: str, lw: float
) -> None:
    total = np.mean([total for _, total in of_seeds], axis=0)
    axes.plot(of_seeds[0][0], total / np.nanmean(total), color=colour, lw=lw)


def _label(
    panels: Sequence[Axes], conditions: Sequence[Condition], xlabel: str, ylabel: str
) -> None:
    """Name the panels after their conditions, and the axes at the lower and the left edge."""
    title_panels(panels, [condition.name for condition in conditions])
    for axes in panels[-_N_COLUMNS:]:
        axes.tick_params(labelbottom=True)
        axes.set_xlabel(xlabel)
    for axes in panels[::_N_COLUMNS]:
        axes.set_ylabel(ylabel)


def _name_row(first: Axes, label: str) -> None:
    name = textwrap.fill(label, _LONGEST_ROW_NAME)
    first.set_ylabel(name, rotation=0, ha="right", va="center")


def _strip(atoms: np.ndarray) -> np.ndarray:
    """Return atoms (n, 128) beside one another, left eye above right eye, each to its own scale."""
    strip = np.ones((2 * PATCH_SIZE_PX, len(atoms) * (PATCH_SIZE_PX + 1) - 1))
    for i, atom in enumerate(atoms):
        first = i * (PATCH_SIZE_PX + 1)
        halves = (atom / (np.abs(atom).max() or 1.0)).reshape(2 * PATCH_SIZE_PX, PATCH_SIZE_PX)
        strip[:, first : first + PATCH_SIZE_PX] = halves
    return strip
