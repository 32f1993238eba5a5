"""Figures of conditions of rearing: one row or one line for each."""

from collections.abc import Callable, Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from experiment_manager.analysis.basis_functions import (
    BINOCULARITY_EDGES,
    ORIENTATION_STEP_DEG,
)
from experiment_manager.analysis.rearing.reared_run import RearedRun
from experiment_manager.analysis.report.dictionary_figures import SCALES
from experiment_manager.analysis.report.performance_figures import new_figure
from eye_plant.geometry import degrees_per_px

Condition = tuple[str, Sequence[RearedRun]]

_N_SAMPLED = 12
_SIDE_PX = 8
_LARGEST_DISPARITY_DEG = 4.0
_N_DISPARITY_BINS = 33  # odd: one is centred on 0
_FLOOR_DEG = 0.01


def curves_figure(conditions: Sequence[Condition]) -> Figure:
    """Return the median |vergence error| of each test over training, mean over seeds.

    A bar across a curve stands where the condition's schedule changes the plant.
    """
    figure = new_figure(8.4, 4.4)
    axes = figure.subplots()
    for (label, runs), colour in _coloured(conditions):
        iterations = sorted(
            set.intersection(*({test.iteration for test in run.results.tests} for run in runs))
        )
        errors_deg = [
            [
                test.median_abs_vergence_error_deg
                for test in run.results.tests
                if test.iteration in iterations
            ]
            for run in runs
        ]
        shown = np.maximum(np.array(errors_deg, dtype=np.float64).mean(axis=0), _FLOOR_DEG)
        axes.plot(np.array(iterations) / 1000.0, shown, "o-", ms=3, color=colour, label=label)
        changed_at = np.array(runs[0].changed_at) / 1000.0
        height = np.exp(np.interp(changed_at, np.array(iterations) / 1000.0, np.log(shown)))
        axes.plot(changed_at, height, "|", ms=14, mew=1.5, color=colour)
    px_deg = degrees_per_px(conditions[0][1][0].focal_length_px)
    axes.axhline(px_deg, color="0.5", lw=0.7, ls=":")
    axes.set(xlabel="training iterations / 1000", ylabel=r"median $|\Delta\gamma|$ / deg")
    axes.set_yscale("log")
    axes.set_yticks([0.05, 0.1, 0.2, 0.5, 1.0, 2.0], ["0.05", "0.1", "0.2", "0.5", "1", "2"])
    axes.minorticks_off()
    figure.legend(loc="outside right upper", fontsize=7)
    return figure


def landscapes_figure(conditions: Sequence[Condition]) -> Figure:
    """Return the reconstruction error over the vergence error, mean over seeds."""
    figure = new_figure(8.4, 4.4)
    axes = figure.subplots()
    for (label, runs), colour in _coloured(conditions):
        total = np.mean([run.landscape.total_error for run in runs], axis=0)
        axes.plot(runs[0].landscape.vergence_error_deg, total, color=colour, label=label)
    axes.axvline(0.0, color="0.5", lw=0.7, ls=":")
    axes.set(xlabel="vergence error / deg", ylabel="reconstruction error, both scales")
    figure.legend(loc="outside right upper", fontsize=7)
    return figure


def samples_figure(conditions: Sequence[Condition]) -> Figure:
    """Return basis functions of each condition's first run, from the most to the least Gabor-like.

    Left eye above right eye.
    """
    figure = new_figure(8.4, 0.75 * len(conditions) + 0.5)
    panels = figure.subplots(len(conditions), len(SCALES), squeeze=False)
    for row, (label, runs) in zip(panels, conditions, strict=True):
        for i_scale, axes in enumerate(row):
            best = runs[0].tunings[i_scale].residual.argsort()
            chosen = best[np.linspace(0, len(best) - 1, _N_SAMPLED).astype(int)]
            axes.imshow(_strip(runs[0].atoms[i_scale][chosen]), cmap="gray", vmin=-1, vmax=1)
            axes.set_axis_off()
        row[0].set_title(label, fontsize=7, loc="left", pad=2)
    for axes, scale in zip(panels[0], SCALES, strict=True):
        axes.text(1.0, 1.06, scale, transform=axes.transAxes, ha="right", fontsize=7)
    return figure


def histograms_figure(conditions: Sequence[Condition]) -> Figure:
    """Return orientation, binocularity and preferred disparity, coarse and fine, all seeds pooled.

    Shares of all basis functions of a scale; coarse is grey, fine an outline.
    """
    columns: tuple[tuple[str, Callable[[Axes, Sequence[RearedRun]], None]], ...] = (
        ("orientation / deg (90 is upright)", _orientations),
        ("binocularity, left to right", _binocularities),
        ("preferred disparity / deg", _disparities),
    )
    figure = new_figure(8.4, 1.15 * len(conditions) + 0.5)
    panels = figure.subplots(len(conditions), len(columns), sharex="col", squeeze=False)
    for row, (label, runs) in zip(panels, conditions, strict=True):
        for axes, (_, draw) in zip(row, columns, strict=True):
            draw(axes, runs)
            axes.tick_params(labelsize=6)
        row[0].set_title(label, fontsize=7, loc="left", pad=2)
    for axes, (name, _) in zip(panels[-1], columns, strict=True):
        axes.set_xlabel(name, fontsize=7)
    return figure


def _orientations(axes: Axes, runs: Sequence[RearedRun]) -> None:
    edges = ORIENTATION_STEP_DEG * (np.arange(9) - 0.5)
    counts = [[run.tunings[i].orientation_counts() for run in runs] for i in range(len(SCALES))]
    _draw_shares(axes, edges, counts, runs)


def _binocularities(axes: Axes, runs: Sequence[RearedRun]) -> None:
    counts = [[run.tunings[i].binocularity_counts() for run in runs] for i in range(len(SCALES))]
    _draw_shares(axes, np.arange(len(BINOCULARITY_EDGES)) - 3.5, counts, runs)


def _disparities(axes: Axes, runs: Sequence[RearedRun]) -> None:
    reach = _LARGEST_DISPARITY_DEG
    edges = np.linspace(-reach, reach, _N_DISPARITY_BINS + 1)
    counts = [
        [
            np.histogram(run.tunings[i].disparities_deg(run.focal_length_px), edges)[0]
            for run in runs
        ]
        for i in range(len(SCALES))
    ]
    _draw_shares(axes, edges, counts, runs)
    axes.axvline(0.0, color="#d62728", lw=0.6)


def _draw_shares(
    axes: Axes,
    edges: np.ndarray,
    counts: Sequence[Sequence[np.ndarray]],
    runs: Sequence[RearedRun],
) -> None:
    """counts: per scale, then per run, (n_bins,)."""
    n_bases = sum(run.atoms.shape[1] for run in runs)
    coarse, fine = (np.sum(of_scale, axis=0) / n_bases for of_scale in counts)
    axes.stairs(coarse, edges, fill=True, color="0.75")
    axes.stairs(fine, edges, color="#1f5fa8", lw=0.9)


def _coloured(conditions: Sequence[Condition]) -> list[tuple[Condition, tuple[float, ...]]]:
    colours = mpl.colormaps["turbo"](np.linspace(0.05, 0.95, len(conditions)))
    return [
        (condition, tuple(colour)) for condition, colour in zip(conditions, colours, strict=True)
    ]


def _strip(atoms: np.ndarray) -> np.ndarray:
    """Return atoms (n, 128) beside one another, left eye above right eye, each to its own scale."""
    strip = np.ones((2 * _SIDE_PX, len(atoms) * (_SIDE_PX + 1) - 1))
    for i, atom in enumerate(atoms):
        first = i * (_SIDE_PX + 1)
        halves = (atom / (np.abs(atom).max() or 1.0)).reshape(2 * _SIDE_PX, _SIDE_PX)
        strip[:, first : first + _SIDE_PX] = halves
    return strip
