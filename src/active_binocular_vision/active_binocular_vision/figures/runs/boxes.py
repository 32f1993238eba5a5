"""Vergence error and saving after a few iterations of the last test (K17 Fig. 3)."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from active_binocular_vision.figures.quartiles import (
    ERROR_LABEL,
    K17_C_PERCENT,
    K17_ERROR_DEG,
    colour_of,
    draw_published,
    label_of,
    offset_of,
    px_deg_of,
    scale_errors,
)
from active_binocular_vision.figures.style import legend_below, mark_level, new_figure, title_panels
from active_binocular_vision.runs.groups import Group
from experiment_manager.measures.metrics import REPORTED_ITERATIONS

# Whiskers of boxes are these percentiles.
_WHISKERS = (5, 95)


def box_figure(groups: Sequence[Group]) -> Figure:
    """Return K17 Fig. 3: box plots after iterations 1, 2, 3 and 20 of the last test.

    groups: with trials. Boxes are quartiles, whiskers the 5th and the 95th percentile.
    """
    figure = new_figure(5.6, 5.6)
    errors, reductions = figure.subplots(2, 1, sharex=True)
    last = [group.last_trials for group in groups]
    shown = [k for k in REPORTED_ITERATIONS if k <= min(trials.n_iterations for trials in last)]
    # The last iteration is far from the others.
    places = np.arange(len(shown)) + 0.5 * (np.diff(shown, prepend=0) > 1)
    width = 0.7 / len(groups)
    for i, (group, trials) in enumerate(zip(groups, last, strict=True)):
        at = places + offset_of(i, groups) * width
        errors_deg = [np.abs(trials.vergence_error_deg[:, k]) for k in shown]
        _draw_boxes(errors, errors_deg, at, width, colour_of(group))
        shares = [100 * trials.cost_reduction(k) for k in shown]
        _draw_boxes(reductions, [c[~np.isnan(c)] for c in shares], at, width, colour_of(group))
    draw_published(reductions, groups, K17_C_PERCENT)
    published = draw_published(errors, groups, K17_ERROR_DEG)
    scale_errors(errors, px_deg_of(groups))
    errors.set_ylabel(ERROR_LABEL)
    mark_level(reductions, 0.0, "as at the start")
    mark_level(reductions, 100.0, "least possible")
    reductions.set(ylabel="$c$ / %", xlabel="iteration of the trial")
    reductions.set_xticks(places, [str(k) for k in shown])
    title_panels((errors, reductions), ("vergence error", "share of the possible saving"))
    handles = [Patch(color=colour_of(g), alpha=0.6, label=label_of(g)) for g in groups]
    legend_below(figure, [*handles, *published])
    return figure


def _draw_boxes(
    axes: Axes, values: Sequence[np.ndarray], positions: np.ndarray, width: float, colour: str
) -> None:
    axes.boxplot(
        list(values),
        positions=list(positions),
        widths=0.85 * width,
        whis=_WHISKERS,
        showfliers=False,
        patch_artist=True,
        boxprops={"facecolor": colour, "alpha": 0.6, "lw": 0.8},
        medianprops={"color": "black", "lw": 1.4},
        whiskerprops={"color": colour},
        capprops={"color": colour},
        manage_ticks=False,
    )
