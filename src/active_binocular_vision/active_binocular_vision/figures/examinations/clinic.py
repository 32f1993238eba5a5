"""Figures of the examinations, as a clinician draws them."""

from collections.abc import Mapping
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from active_binocular_vision.examinations.clinic.cover import AXES, CoverTraces
from active_binocular_vision.examinations.clinic.gratings import Resolution
from active_binocular_vision.examinations.clinic.prisms import (
    DIRECTIONS,
    PrismTraces,
    PrismTrial,
)
from active_binocular_vision.examinations.clinic.stereo import StereoCurve
from active_binocular_vision.figures.quartiles import draw_band
from active_binocular_vision.figures.style import (
    BLUE,
    GREY,
    LIGHT_GREY,
    VERMILION,
    WIDTH_IN,
    legend_below,
    mark_level,
    new_figure,
    title_panels,
)
from experiment_manager.measures.metrics import QUARTILES
from lockstep import SIDES

# Of left and right eye, and of near and far.
_COLOURS = (BLUE, VERMILION)
_CLINICAL = (("eso", "exo"), ("hyper", "hypo"))


def cover_figure(results: CoverTraces) -> Figure:
    """Return the deviation of the covered eye over the test, a column for each distance."""
    figure = new_figure(WIDTH_IN, 4.6)
    rows = figure.subplots(2, len(results.distances_m), sharex=True, sharey="row", squeeze=False)
    for axes, distance_m in zip(rows.T, results.distances_m, strict=True):
        for side, colour in zip(SIDES, _COLOURS, strict=True):
            trials = results.trials[side, distance_m]
            deviation_deg = np.quantile([t.deviation_deg for t in trials], QUARTILES, axis=0)
            iterations = np.arange(deviation_deg.shape[1])
            for i_axis, panel in enumerate(axes):
                draw_band(panel, iterations, deviation_deg[..., i_axis], colour)
        for panel in axes:
            panel.axvspan(trials[0].begin, trials[0].end, color=LIGHT_GREY, alpha=0.5, lw=0)
            for level_deg in (-results.px_deg, results.px_deg):
                panel.axhline(level_deg, color=GREY, lw=0.8, ls=":", zorder=1)
        axes[-1].set_xlabel("iteration")
    for axis, (above, below), panel in zip(AXES, _CLINICAL, rows[:, 0], strict=False):
        panel.set_ylabel(f"{axis} deviation / deg\n{below} < 0 < {above}")
    title_panels(
        rows.ravel(), [f"{axis}, {m:g} m" for axis in AXES[:2] for m in results.distances_m]
    )
    handles = [
        Line2D([], [], color=colour, label=f"{side} eye covered")
        for side, colour in zip(SIDES, _COLOURS, strict=True)
    ]
    pixel = Line2D([], [], color=GREY, lw=0.8, ls=":", label="1 px")
    cover = Patch(color=LIGHT_GREY, alpha=0.5, label="cover")
    n = Line2D([], [], ls="", label=f"n = {len(trials)} stimuli")
    legend_below(figure, [*handles, cover, pixel, n])
    return figure


def prisms_figure(results: PrismTraces) -> Figure:
    """Return the fixation disparity over the demand of prisms: a row for each distance.

    A column for each axis, a line for each picture, as long as the prism grows. The eyes respond
    with the demand less the fixation disparity.
    """
    n_rows = len(results.distances_m)
    figure = new_figure(WIDTH_IN, 2.2 * n_rows + 0.9)
    rows = figure.subplots(n_rows, 3, sharex="col", sharey="col", squeeze=False)
    pairs = list(zip(DIRECTIONS[::2], DIRECTIONS[1::2], strict=True))
    for distance_m, row in zip(results.distances_m, rows, strict=True):
        for axes, pair in zip(row, pairs, strict=True):
            for sign, direction in zip((1.0, -1.0), pair, strict=True):
                for trial in results.trials[direction.name, distance_m]:
                    _draw_prisms(axes, trial, sign)
        row[0].set_ylabel("fixation disparity / deg")
        for axes in row[:2]:  # pixels do not measure torsion
            for level_deg in (-results.px_deg, results.px_deg):
                axes.axhline(level_deg, color=GREY, lw=0.8, ls=":", zorder=1)
    for axes, (above, below) in zip(rows[-1], pairs, strict=True):
        axes.set_xlabel(f"demand / deg\n{below.name} < 0 < {above.name}")
    titles = [
        f"{axis}, {m:g} m"
        for m in results.distances_m
        for axis in ("horizontal", "vertical", "torsional")
    ]
    title_panels(rows.ravel(), titles)
    dots: dict[str, Any] = {"color": BLUE, "ls": "", "marker": "o", "ms": 5}
    n_pictures = len(next(iter(results.trials.values())))
    handles = [
        Line2D([], [], color=BLUE, lw=0.8, label=f"each of n = {n_pictures} stimuli"),
        Line2D([], [], label="break", **dots),
        Line2D([], [], label="recovery", mfc="w", **dots),
        Line2D([], [], color=GREY, lw=0.8, ls=":", label="1 px"),
    ]
    legend_below(figure, handles)
    return figure


def _draw_prisms(axes: Axes, trial: PrismTrial, sign: float) -> None:
    rising = slice(0, trial.i_turn + 1)
    demand_deg, lag_deg = sign * trial.demand_deg, sign * trial.lag_deg
    axes.plot(demand_deg[rising], lag_deg[rising], color=BLUE, lw=0.8, alpha=0.7)
    for i_step, face in ((trial.i_break, BLUE), (trial.i_recovery, "w")):
        if i_step is not None:
            axes.plot(demand_deg[i_step], lag_deg[i_step], "o", color=BLUE, mfc=face, ms=5)


def acuity_figure(seen: Mapping[str, Resolution]) -> Figure:
    """Return the explained share of gratings before one eye over spatial frequency."""
    figure = new_figure(WIDTH_IN / 2.0, 3.4)
    axes = figure.subplots()
    styles = list(zip(SIDES, _COLOURS, ("-", "--"), strict=True))
    for side, colour, dashes in styles:
        of_eye = seen[side]
        axes.plot(of_eye.cycles_per_deg, of_eye.explained, dashes, color=colour, marker="o", ms=3)
        if of_eye.acuity is not None:
            axes.axvline(of_eye.acuity, color=colour, ls=dashes, lw=0.8)
    axes.set_xscale("log")
    axes.xaxis.set_major_formatter(mpl.ticker.FormatStrFormatter("%g"))
    axes.set(xlabel="spatial frequency / (cycles/deg)", ylabel="explained share", ylim=(0, 1.03))
    mark_level(axes, 0.5, "1/2")
    handles = [
        Line2D([], [], color=colour, ls=dashes, label=f"{side} eye; thin: its acuity")
        for side, colour, dashes in styles
    ]
    n = Line2D([], [], ls="", label=f"n = {of_eye.shares.shape[1]} gratings each")
    legend_below(figure, [*handles, n])
    return figure


def stereo_figure(curve: StereoCurve) -> Figure:
    """Return how often the first command of vergence is right, over the size of the disparity."""
    figure = new_figure(WIDTH_IN / 2.0, 3.4)
    axes = figure.subplots()
    too_much, too_little = curve.right_by_sign
    looks: tuple[tuple[Any, str, dict[str, Any]], ...] = (
        (too_much, "converged too much", {"color": BLUE, "marker": "s", "lw": 0.8}),
        (too_little, "converged too little", {"color": VERMILION, "marker": "^", "lw": 0.8}),
        (curve.right, "both", {"color": "k", "marker": "o", "lw": 1.6}),
    )
    for shares, label, look in looks:
        axes.plot(curve.disparity_deg, shares, ms=3.5, label=label, **look)
    axes.set_xscale("log")
    axes.xaxis.set_major_formatter(mpl.ticker.FormatStrFormatter("%g"))
    axes.set(xlabel="disparity / deg", ylabel="share of correct commands", ylim=(-0.03, 1.03))
    mark_level(axes, 0.5, "1/2")
    mark_level(axes, 0.75, "3/4")
    if curve.threshold_deg is not None:
        axes.axvline(curve.threshold_deg, color=GREY, lw=0.8, label="stereo threshold, both")
    n = Line2D([], [], ls="", label=f"n = {curve.n_trials} trials each")
    legend_below(figure, [*axes.get_legend_handles_labels()[0], n])
    return figure
