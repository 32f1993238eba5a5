"""The sheet of figures: a row for each condition, a column for each measure."""

import textwrap
from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

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
from active_binocular_vision.pages.clinic.rows import Row
from active_binocular_vision.runs.examined_run import AGES, BEFORE, BIRTH, END

_PERCENT, _ACUITY = (0.0, 50.0, 100.0), (0.0, 1.0, 2.0)
# Measure, name of the axis, factor, and ticks where the range is known.
_COLUMNS: tuple[tuple[str, str, float, tuple[float, ...] | None], ...] = (
    ("horizontal_deviation_pd", "deviation\nPD\neso > 0", 1.0, None),
    ("vertical_deviation_pd", "deviation\nPD\nhyper > 0", 1.0, None),
    ("share_fused", "fused\n%", 100.0, _PERCENT),
    ("left_acuity_cycles_per_deg", "acuity, left\ncycles/deg", 1.0, _ACUITY),
    ("right_acuity_cycles_per_deg", "acuity, right\ncycles/deg", 1.0, _ACUITY),
    ("binocular_share_fine", "binocular\n%", 100.0, _PERCENT),
    ("metabolic_rate_w", "energy\nW", 1.0, None),
)
_STYLES: dict[str, dict[str, Any]] = {
    BIRTH: {"color": GREY, "marker": "o", "mfc": "w"},
    BEFORE: {"color": ORANGE, "marker": "s"},
    END: {"color": BLUE, "marker": "D"},
}
_LABELS = {BIRTH: "birth", BEFORE: "before the treatment or the palsy", END: "end"}
_SIZE_PT = 4.5
# Marks of a row stand below one another.
_OFFSETS = dict(zip(AGES, (-0.2, 0.0, 0.2), strict=True))
_MARGIN_SHARE = 0.15
_LONGEST_LINE = 22  # characters of a row's name
_LINE_IN, _GAP_IN, _OTHER_IN = 0.15, 0.08, 1.4


def clinic_figure(rows: Sequence[Row]) -> Figure:
    """Return the measures of all rows: medians over seeds, lines from the least to the greatest."""
    names = [textwrap.fill(row.name, _LONGEST_LINE) for row in rows]
    n_lines = 1 + max(name.count("\n") for name in names)
    row_in = _LINE_IN * n_lines + _GAP_IN
    figure = new_figure(WIDTH_IN, row_in * len(rows) + _OTHER_IN)
    panels = figure.subplots(1, len(_COLUMNS), sharey=True)
    for axes, (measure, name, factor, ticks) in zip(panels, _COLUMNS, strict=True):
        for i_row, row in enumerate(rows):
            _draw(axes, row, i_row, measure, factor)
        axes.set_xlabel(name)
        axes.xaxis.set_major_locator(mpl.ticker.MaxNLocator(2))
        axes.margins(x=_MARGIN_SHARE)
        if ticks is not None:
            margin = _MARGIN_SHARE * ticks[-1]
            axes.set(xticks=ticks, xlim=(-margin, ticks[-1] + margin))
        axes.grid(axis="y", color=LIGHT_GREY, lw=0.5)
        axes.tick_params(axis="y", length=0)
    for axes in panels[:2]:
        axes.axvline(0.0, color=GREY, lw=0.8, ls=":", zorder=1)
    panels[-1].set_xlim(left=0.0)
    panels[0].set_yticks(range(len(rows)), names)
    panels[0].set_ylim(len(rows) - 0.5, -0.5)
    title_panels(panels, [""] * len(panels))
    shown = [when for when in AGES if any(run.at(when) for row in rows for run in row.runs)]
    handles = [
        Line2D([], [], ls="", ms=_SIZE_PT, label=_LABELS[when], **_STYLES[when]) for when in shown
    ]
    legend_below(figure, handles)
    return figure


def _draw(axes: Axes, row: Row, i_row: int, measure: str, factor: float) -> None:
    for when in AGES:
        found = row.over_seeds(when, measure)
        if found is None:
            continue
        y = i_row + _OFFSETS[when]
        axes.plot(
            (factor * found.least, factor * found.greatest),
            (y, y),
            color=_STYLES[when]["color"],
            lw=1.0,
        )
        axes.plot(factor * found.median, y, ls="", ms=_SIZE_PT, **_STYLES[when])
