"""Figures of the examinations, as a clinician draws them."""

from collections.abc import Mapping, Sequence
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
    Array,
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
    legend_below(figure, [*handles, Patch(color=LIGHT_GREY, alpha=0.5, label="cover"), pixel])
    return figure


def prisms_figure(results: PrismTraces) -> Figure:
    """Return response and fixation disparity over the demand of prisms, a column for each axis.

    A line for each picture, as long as the prism grows.
    """
    figure = new_figure(WIDTH_IN, 5.4)
    rows = figure.subplots(2, 3, sharex="col")
    pairs = zip(DIRECTIONS[::2], DIRECTIONS[1::2], strict=True)
    for column, pair in zip(rows.T, pairs, strict=True):
        for distance_m, colour in zip(results.distances_m, _COLOURS, strict=False):
            for sign, direction in zip((1.0, -1.0), pair, strict=True):
                for trial in results.trials[direction.name, distance_m]:
                    for axes, values in zip(
                        column, (trial.response_deg, trial.lag_deg), strict=True
                    ):
                        _draw_prisms(axes, trial, values, sign, colour)
        low, high = column[0].get_xlim()
        column[0].plot((low, high), (low, high), color=GREY, lw=0.8, ls=":", zorder=1)
        column[1].set_xlabel(f"demand / deg\n{pair[1].name} < 0 < {pair[0].name}")
    for axes in rows[1, :2]:
        for level_deg in (-results.px_deg, results.px_deg):
            axes.axhline(level_deg, color=GREY, lw=0.8, ls=":", zorder=1)
    rows[0, 0].set_ylabel("response of the eyes / deg")
    rows[1, 0].set_ylabel("fixation disparity / deg")
    title_panels(rows.ravel(), ("horizontal", "vertical", "torsional") * 2)
    legend_below(figure, _prism_handles(results.distances_m))
    return figure


def _prism_handles(distances_m: Sequence[float]) -> list[Line2D]:
    dots: dict[str, Any] = {"color": "k", "ls": "", "marker": "o", "ms": 5}
    return [
        *(
            Line2D([], [], color=colour, label=f"{distance_m:g} m")
            for distance_m, colour in zip(distances_m, _COLOURS, strict=False)
        ),
        Line2D([], [], label="break", **dots),
        Line2D([], [], label="recovery", mfc="w", **dots),
        Line2D([], [], color=GREY, lw=0.8, ls=":", label="response = demand; 1 px"),
    ]


def _draw_prisms(axes: Axes, trial: PrismTrial, values: Array, sign: float, colour: str) -> None:
    rising = slice(0, trial.i_turn + 1)
    demand_deg, shown_deg = sign * trial.demand_deg, sign * values
    axes.plot(demand_deg[rising], shown_deg[rising], color=colour, lw=0.8, alpha=0.7)
    for i_step, face in ((trial.i_break, colour), (trial.i_recovery, "w")):
        if i_step is not None:
            axes.plot(demand_deg[i_step], shown_deg[i_step], "o", color=colour, mfc=face, ms=5)


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
    legend_below(figure, handles)
    return figure


def stereo_figure(curve: StereoCurve) -> Figure:
    """Return the psychometric curve: how often the first command of vergence converges."""
    figure = new_figure(WIDTH_IN / 2.0, 3.4)
    axes = figure.subplots()
    signed_deg, converging = curve.converging
    axes.plot(signed_deg, converging, color="k", marker="o", ms=3)
    axes.set_xscale("symlog", linthresh=float(curve.disparity_deg[0]), linscale=0.5)
    ticks_deg = (0.02, 0.1, 0.5, 2.0)
    places_deg = [*(-t for t in reversed(ticks_deg)), *ticks_deg]
    axes.set_xticks(places_deg, [f"{t:g}".replace("-", "\N{MINUS SIGN}") for t in places_deg])
    axes.xaxis.set_minor_locator(mpl.ticker.NullLocator())
    axes.set(
        xlabel="disparity / deg\nconverged too much < 0 < too little",
        ylabel="share of commands that converge",
        ylim=(-0.03, 1.03),
    )
    axes.axhline(0.5, color=GREY, lw=0.8, ls=":")
    threshold_deg = curve.threshold_deg
    if threshold_deg is not None:
        axes.axvspan(-threshold_deg, threshold_deg, color=LIGHT_GREY, alpha=0.5, lw=0)
    below = Patch(color=LIGHT_GREY, alpha=0.5, label="below the stereo threshold")
    legend_below(figure, [below])
    return figure
