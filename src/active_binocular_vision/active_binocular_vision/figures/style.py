"""The one style of all figures: sizes, colours, panel letters, legends and logarithmic axes.

Figures are made inside `own_style()`. No text is smaller than 8 pt on a page that shows a figure at
its own width, which is at most WIDTH_IN.
"""

import math
import textwrap
from collections.abc import Iterable, Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from string import ascii_lowercase
from typing import Any

import matplotlib as mpl
import matplotlib.style
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

WIDTH_IN = 8.0
SMALLEST_PT = 8.0
DPI = 150
# The folder of a run or a report for pictures.
FIGURES = "figures"

# Okabe & Ito 2008: readers with any kind of colour vision can tell them apart.
BLUE, VERMILION, GREEN = "#0072b2", "#d55e00", "#009e73"
ORANGE, SKY, PURPLE = "#e69f00", "#56b4e9", "#cc79a7"
GREY, LIGHT_GREY = "0.45", "0.8"
BAND_ALPHA = 0.2

_STYLE: dict[str, Any] = {
    "font.size": 9,
    "axes.titlesize": 9,
    "axes.labelsize": 9,
    "xtick.labelsize": 8.5,
    "ytick.labelsize": 8.5,
    "legend.fontsize": 8.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
    "lines.linewidth": 1.4,
}

_STEPS = (1.0, 2.0, 5.0)
# Inches of a figure's height that a legend may take.
_LEGEND_HEIGHT_IN = 0.5
# Characters of a line of a legend.
_LONGEST_LINE = 68


def own_style() -> AbstractContextManager[None]:
    """Return the context to draw in: our style over matplotlib's, whatever a user's file has."""
    return mpl.style.context(("default", _STYLE))


def new_figure(width_in: float, height_in: float) -> Figure:
    """Return an empty figure; no window system is involved."""
    return Figure(figsize=(width_in, height_in), layout="constrained")


def panel_grid(
    n_panels: int, n_columns: int, panel_height_in: float, *, share: bool = False
) -> tuple[Figure, list[Axes]]:
    """Return a figure, WIDTH_IN wide for a full row, and so many panels, row by row.

    share: all panels have the same axes.
    """
    n_columns = min(n_panels, n_columns)
    n_rows = -(-n_panels // n_columns)
    figure = new_figure(WIDTH_IN, panel_height_in * n_rows + 0.4)
    panels = figure.subplots(n_rows, n_columns, squeeze=False, sharex=share, sharey=share).ravel()
    for axes in panels[n_panels:]:
        axes.set_axis_off()
    return figure, list(panels[:n_panels])


def save(figure: Figure, path: Path) -> Path:
    """Write a figure as PNG and return the path; makes its directory."""
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=DPI)
    return path


def title_panels(panels: Iterable[Axes], titles: Iterable[str]) -> None:
    """Give each panel its letter, a, b, c ..., in front of its title."""
    for letter, axes, title in zip(ascii_lowercase, panels, titles, strict=False):
        axes.set_title(rf"$\bf{{{letter}}}$  {title}".rstrip(), loc="left")


def legend_below(figure: Figure, handles: Sequence[Any]) -> None:
    """Put a legend below a figure, in as many of three columns as have room.

    The figure grows by what a long one needs.
    """
    # Measured without the layout, which would find no room for the axes above a long legend.
    renderer = FigureCanvasAgg(figure).get_renderer()
    for n_columns in (3, 2, 1):
        legend = figure.legend(handles=handles, loc="outside lower center", ncols=n_columns)
        if n_columns == 1 or legend.get_window_extent(renderer).width <= figure.bbox.width:
            break
        legend.remove()
    for text in legend.get_texts():
        text.set_text(textwrap.fill(text.get_text(), _LONGEST_LINE))
    needed_in = legend.get_window_extent(renderer).height / figure.dpi
    figure.set_figheight(figure.get_figheight() + max(0.0, needed_in - _LEGEND_HEIGHT_IN))


def mark_level(axes: Axes, level: float, name: str) -> None:
    """Draw a dotted line at a height of the axes, if in sight; its name stands to the right."""
    axes.axhline(level, color=GREY, lw=0.8, ls=":", zorder=1)
    low, high = axes.get_ylim()
    if not low <= level <= high:
        return
    axes.annotate(
        name,
        (1.0, level),
        (3, 0),
        va="center",
        xycoords=("axes fraction", "data"),
        textcoords="offset points",
        color=GREY,
        fontsize=SMALLEST_PT,
    )


def break_axis(axes: Axes, at: float) -> None:
    """Mark that the horizontal axis is broken at a place."""
    axes.annotate(
        "//",
        (at, 0.0),
        xycoords=("data", "axes fraction"),
        ha="center",
        va="center",
        color=GREY,
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.5},
    )


def scale_by_decades(axes: Axes) -> bool:
    """Make the upright axis logarithmic, unless nothing is above 0; return whether it is."""
    is_any = bool(axes.dataLim.y1 > 0.0)
    if is_any:
        axes.set_yscale("log")
    return is_any


def label_decades(axes: Axes) -> None:
    """Let a logarithmic axis begin and end at 1, 2 or 5 times a power of ten: labelled ticks."""
    if not scale_by_decades(axes):
        return
    low, high = axes.get_ylim()
    reach = range(math.floor(math.log10(low)) - 1, math.ceil(math.log10(high)) + 2)
    steps = [step * 10.0**decade for decade in reach for step in _STEPS]
    below = max(step for step in steps if step <= low)
    above = min(step for step in steps if step >= high)
    axes.set_ylim(below, above)
    axes.yaxis.set_major_locator(mpl.ticker.FixedLocator([s for s in steps if below <= s <= above]))
    axes.yaxis.set_major_formatter(mpl.ticker.FormatStrFormatter("%g"))
    axes.yaxis.set_minor_formatter(mpl.ticker.NullFormatter())
