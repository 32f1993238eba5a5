"""What each muscle does, where each has a command of its own."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FormatStrFormatter

from active_binocular_vision.figures.quartiles import draw_bars
from active_binocular_vision.figures.style import (
    BLUE,
    VERMILION,
    WIDTH_IN,
    legend_below,
    new_figure,
    title_panels,
)
from active_binocular_vision.runs.groups import Group
from experiment_manager.measures.metrics import QUARTILES, antagonist_names
from lockstep import SIDES

# Of the first and the second of two antagonists: hue, and where from a distance's place.
_COLOURS = (BLUE, VERMILION)
_DIRECTIONS = (-1, 1)
# From a distance's place to the start and to the end of trials there.
_START, _END = 0.30, 0.14


def activations_figure(group: Group) -> Figure:
    """Return activations at the start and at the end of the last test's trials, over distance.

    A row for each eye, a panel for each two antagonists; median and quartiles. group: with trials,
    of commands of their own.
    """
    trials = group.last_trials
    pairs = antagonist_names(trials.space)
    n_columns = len(pairs) // len(SIDES)
    figure = new_figure(WIDTH_IN if n_columns > 1 else WIDTH_IN / 2, 5.2)
    rows = figure.subplots(len(SIDES), n_columns, sharex=True, sharey=True, squeeze=False)
    distances_m = np.unique(trials.object_distance_m)
    for axes, names in zip(rows.ravel(), pairs, strict=True):
        for name, colour, direction in zip(names, _COLOURS, _DIRECTIONS, strict=True):
            for iteration, offset, face in ((0, _START, "white"), (-1, _END, colour)):
                values = trials.column(name)[:, iteration]
                quartiles = [
                    np.nanquantile(values[trials.object_distance_m == d], QUARTILES)
                    for d in distances_m
                ]
                places = np.arange(len(distances_m)) + direction * offset
                draw_bars(axes, places, np.array(quartiles).T, colour, ms=4, mfc=face)
        _describe(axes, names)
    title_panels(rows.ravel(), [""] * len(pairs))
    for side, row in zip(SIDES, rows, strict=True):
        row[0].set_ylabel(f"activation, {side} eye")
    for axes in rows[-1]:
        axes.set_xticks(range(len(distances_m)), [f"{d:g}" for d in distances_m])
        axes.set_xlabel("object distance / m")
    rows[0, 0].set_ylim(0, None)
    rows[0, 0].yaxis.set_major_formatter(FormatStrFormatter("%g"))
    ends = {"start of the trial": "white", "its end": "0.3"}
    handles = [_handle("0.3", face, label) for label, face in ends.items()]
    legend_below(figure, handles)
    return figure


def _describe(axes: Axes, names: Sequence[str]) -> None:
    """Write the names of both muscles above their panel, in their colours."""
    labels = [
        name.partition("_")[2].replace("_", " ").replace("erior", ".") for name in names
    ]  # sup., inf.: beside the panel's letter
    handles = [_handle(c, c, label) for c, label in zip(_COLOURS, labels, strict=True)]
    axes.legend(
        handles=handles,
        loc="lower right",
        bbox_to_anchor=(1.05, 0.98),
        ncols=2,
        fontsize=8,
        handletextpad=0.1,
        columnspacing=0.8,
    )


def _handle(colour: str, face: str, label: str) -> Line2D:
    return Line2D([], [], ls="", marker="o", ms=5, color=colour, mfc=face, label=label)
