"""The sheet of conditions: a row for each, a panel for each measure, a colour for each model."""

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
    VERMILION,
    WIDTH_IN,
    legend_below,
    new_figure,
    title_panels,
)
from active_binocular_vision.runs.ages import AGES, BEFORE, BIRTH, END
from active_binocular_vision.runs.conditions import Column, Condition

MOST_COLUMNS = 6
PERCENT_TICKS = (0.0, 50.0, 100.0)
_MARKS: dict[str, dict[str, Any]] = {
    BIRTH: {"marker": "o", "mfc": "w"},
    BEFORE: {"marker": "s", "mfc": "w"},
    END: {"marker": "D"},
}
_LABELS = {BIRTH: "birth", BEFORE: "before the first change", END: "end"}
_COLOURS = {"M": BLUE, "M_C": VERMILION}
_SIZE_PT = 4.5
# Marks of a row stand below one another: models, and their ages.
_MODEL_ASIDE, _AGE_ASIDE = 0.36, 0.14
_MARGIN_SHARE = 0.15
_LONGEST_LINE, _LONGEST_HEADING = 22, 13  # characters of a row's and of a column's name
_LINE_IN, _GAP_IN, _OTHER_IN = 0.16, 0.2, 1.4


def sheet_figure(conditions: Sequence[Condition], columns: Sequence[Column]) -> Figure:
    """Return measures of all conditions: medians over seeds, lines from least to greatest.

    columns: at most MOST_COLUMNS.
    """
    rows = _rows_of(conditions)
    names = [textwrap.fill(name, _LONGEST_LINE) for name in rows]
    n_lines = 1 + max(name.count("\n") for name in names)
    figure = new_figure(WIDTH_IN, (_LINE_IN * n_lines + _GAP_IN) * len(rows) + _OTHER_IN)
    panels = figure.subplots(1, len(columns), sharey=True, squeeze=False)[0]
    for axes, column in zip(panels, columns, strict=True):
        for i, of_row in enumerate(rows.values()):
            for condition in of_row:
                _draw(axes, condition, i, column)
        axes.xaxis.set_major_locator(mpl.ticker.MaxNLocator(2))
        axes.margins(x=_MARGIN_SHARE)
        if column.declared.unit == SHARE:
            margin = _MARGIN_SHARE * PERCENT_TICKS[-1]
            axes.set(xticks=PERCENT_TICKS, xlim=(-margin, PERCENT_TICKS[-1] + margin))
        elif axes.get_xlim()[0] < 0.0 < axes.get_xlim()[1]:
            axes.axvline(0.0, color=GREY, lw=0.8, ls=":", zorder=1)
        axes.grid(axis="y", color=LIGHT_GREY, lw=0.5)
        axes.tick_params(axis="y", length=0)
    panels[0].set_yticks(range(len(rows)), names)
    panels[0].set_ylim(len(rows) - 0.5, -0.5)
    title_panels(panels, [heading_of(column) for column in columns])
    shown = [age for age in AGES if any(age in run.found for of in conditions for run in of.runs)]
    handles = [
        Line2D([], [], ls="", ms=_SIZE_PT, color=GREY, label=_LABELS[age], **_MARKS[age])
        for age in shown
    ]
    models = {condition.runs[0].model for condition in conditions}
    handles += [
        Line2D([], [], lw=2.0, color=_COLOURS.get(model, "black"), label=model)
        for model in sorted(models)
    ]
    legend_below(figure, [*handles, range_handle(conditions)])
    return figure


def _rows_of(conditions: Sequence[Condition]) -> dict[str, list[Condition]]:
    """Return the conditions by name, models aside."""
    rows: dict[str, list[Condition]] = {}
    for condition in conditions:
        parts = [part for part in condition.name.split(", ") if part != condition.runs[0].model]
        rows.setdefault(", ".join(parts), []).append(condition)
    return rows


def range_handle(conditions: Sequence[Condition]) -> Line2D:
    """Return what says of how many seeds marks and lines are."""
    label = f"least to greatest of {n_seeds(conditions)}"
    return Line2D([], [], color=GREY, lw=1.0, label=label)


def n_seeds(conditions: Sequence[Condition]) -> str:
    """Return how many seeds conditions have, as text."""
    counts = sorted({len(condition.runs) for condition in conditions})
    return f"n = {' to '.join(str(n) for n in sorted({counts[0], counts[-1]}))} seeds"


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
        model = condition.runs[0].model
        i_model = list(_COLOURS).index(model) if model in _COLOURS else 0
        y = i + _MODEL_ASIDE * (i_model - 0.5) + _AGE_ASIDE * (list(AGES).index(age) - 1)
        colour = _COLOURS.get(model, "black")
        axes.plot((found.least, found.greatest), (y, y), color=colour, lw=1.0)
        axes.plot(found.median, y, ls="", ms=_SIZE_PT, color=colour, **_MARKS[age])
