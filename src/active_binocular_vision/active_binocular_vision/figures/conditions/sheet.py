"""The sheet of conditions: a row for each, a panel for each measure."""

import textwrap
from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from active_binocular_vision.examinations.contract.measure import SHARE
from active_binocular_vision.figures.style import (
    BLUE,
    GREY,
    LIGHT_GREY,
    ORANGE,
    WIDTH_IN,
    legend_below,
    new_figure,
    title_panels,
)
from active_binocular_vision.runs.ages import AGES, BEFORE, BIRTH, END
from active_binocular_vision.runs.conditions import Column, Condition

MOST_COLUMNS = 6
PERCENT_TICKS = (0.0, 50.0, 100.0)
_STYLES: dict[str, dict[str, Any]] = {
    BIRTH: {"color": GREY, "marker": "o", "mfc": "w"},
    BEFORE: {"color": ORANGE, "marker": "s"},
    END: {"color": BLUE, "marker": "D"},
}
_LABELS = {BIRTH: "birth", BEFORE: "before the first change", END: "end"}
_SIZE_PT = 4.5
# Marks of a row stand below one another.
_OFFSETS = dict(zip(AGES, (-0.2, 0.0, 0.2), strict=True))
_MARGIN_SHARE = 0.15
_LONGEST_LINE, _LONGEST_HEADING = 22, 13  # characters of a row's and of a column's name
_LINE_IN, _GAP_IN, _OTHER_IN = 0.15, 0.08, 1.4


def sheet_figure(conditions: Sequence[Condition], columns: Sequence[Column]) -> Figure:
    """Return measures of all conditions: medians over seeds, lines from least to greatest.

    columns: at most MOST_COLUMNS.
    """
    names = [textwrap.fill(condition.name, _LONGEST_LINE) for condition in conditions]
    n_lines = 1 + max(name.count("\n") for name in names)
    figure = new_figure(WIDTH_IN, (_LINE_IN * n_lines + _GAP_IN) * len(conditions) + _OTHER_IN)
    panels = figure.subplots(1, len(columns), sharey=True, squeeze=False)[0]
    for axes, column in zip(panels, columns, strict=True):
        for i, condition in enumerate(conditions):
            _draw(axes, condition, i, column)
        axes.set_xlabel(heading_of(column))
        axes.xaxis.set_major_locator(mpl.ticker.MaxNLocator(2))
        axes.margins(x=_MARGIN_SHARE)
        if column.declared.unit == SHARE:
            margin = _MARGIN_SHARE * PERCENT_TICKS[-1]
            axes.set(xticks=PERCENT_TICKS, xlim=(-margin, PERCENT_TICKS[-1] + margin))
        elif axes.get_xlim()[0] < 0.0 < axes.get_xlim()[1]:
            axes.axvline(0.0, color=GREY, lw=0.8, ls=":", zorder=1)
        axes.grid(axis="y", color=LIGHT_GREY, lw=0.5)
        axes.tick_params(axis="y", length=0)
    panels[0].set_yticks(range(len(conditions)), names)
    panels[0].set_ylim(len(conditions) - 0.5, -0.5)
    title_panels(panels, [""] * len(panels))
    shown = [age for age in AGES if any(age in run.found for of in conditions for run in of.runs)]
    handles = [
        Line2D([], [], ls="", ms=_SIZE_PT, label=_LABELS[age], **_STYLES[age]) for age in shown
    ]
    legend_below(figure, handles)
    return figure


def heading_of(column: Column) -> str:
    """Return a column's heading for a narrow panel, the unit in a line of its own."""
    name, slash, unit = column.heading.partition("/")
    return textwrap.fill(name.strip(), _LONGEST_HEADING) + (
        f"\n{unit.strip(' ()')}" if slash else ""
    )


def _draw(axes: Axes, condition: Condition, i: int, column: Column) -> None:
    for age in AGES:
        found = condition.over_seeds(age, column)
        if found is None:
            continue
        y = i + _OFFSETS[age]
        axes.plot((found.least, found.greatest), (y, y), color=_STYLES[age]["color"], lw=1.0)
        axes.plot(found.median, y, ls="", ms=_SIZE_PT, **_STYLES[age])
