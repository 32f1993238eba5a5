"""How a run learned: vergence error and metabolic rate of the tests over training (K17 Fig. 2)."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from active_binocular_vision.figures.quartiles import (
    DELTA_LABEL,
    ERROR_LABEL,
    K17_ERROR_DEG,
    LEAST_JOINED,
    colour_of,
    draw_band,
    draw_published,
    draw_quartiles,
    final_errors_deg,
    group_handle,
    interval_handles,
    of_seeds,
    offset_of,
    over_training,
    px_deg_of,
    scale_errors,
)
from active_binocular_vision.figures.style import (
    FIGURES,
    GREY,
    legend_below,
    mark_level,
    new_figure,
    own_style,
    save,
    title_panels,
)
from active_binocular_vision.runs.groups import Group, groups_of
from active_binocular_vision.runs.recorded import TrainingCurve
from active_binocular_vision.runs.run import Run
from experiment_manager import Summary, Trials


def learning_curve(directory: Path) -> Path:
    """Draw how a run learned, from its bag, into figures/learning_curve.png; return that path."""
    run = Run(directory)
    with own_style():
        return save(learning_curve_figure(run), Path(directory) / FIGURES / "learning_curve.png")


def learning_curve_figure(run: Run) -> Figure:
    """Return the figure of one run: its tests, and its training episodes if its bag is there."""
    training = run.recorded.training_curve if run.bag is not None else None
    return performance_figure(groups_of([run]), training)


def performance_figure(groups: Sequence[Group], training: TrainingCurve | None = None) -> Figure:
    """Return K17 Fig. 2: |vergence error| and Delta C of the tests over training.

    training: drawn behind the tests. Median and quartiles; without trials the medians alone.
    """
    figure = new_figure(7.0, 5.2)
    errors, deltas = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    handles: list[Any] = [group_handle(group) for group in groups]
    if training is not None:
        for axes, quartiles in ((errors, training.quartiles_deg), (deltas, training.quartiles_w)):
            if not np.isnan(quartiles).all():  # C* is not known in training with gaze targets
                draw_band(axes, training.iteration, quartiles, GREY, lw=1.0)
        handles.append(Line2D([], [], color=GREY, lw=1.0, label="ends of training episodes"))
    for i, group in enumerate(groups):
        offset = offset_of(i, groups)
        _draw_tests(
            errors, group, final_errors_deg, lambda t: t.median_abs_vergence_error_deg, offset
        )
        _draw_tests(deltas, group, _final_deltas_w, lambda t: t.median_delta_cost_w, offset)
    handles += [*interval_handles(groups), *draw_published(errors, groups, K17_ERROR_DEG)]
    scale_errors(errors, px_deg_of(groups))
    errors.set_ylabel(ERROR_LABEL)
    mark_level(deltas, 0.0, "")
    if min(group.iterations[0] for group in groups) > 0:
        deltas.set_xlim(left=0.0)
    deltas.set(xlabel="training iterations", ylabel=DELTA_LABEL)
    deltas.xaxis.set_major_formatter(mpl.ticker.EngFormatter(sep=""))
    title_panels((errors, deltas), ("vergence error", "metabolic rate above the least possible"))
    legend_below(figure, handles)
    return figure


def _final_deltas_w(trials: Trials) -> np.ndarray:
    return trials.delta_cost_w(trials.n_iterations)


def _draw_tests(
    axes: Axes,
    group: Group,
    values: Callable[[Trials], np.ndarray],
    measure: Callable[[Summary], float | None],
    offset: float,
) -> None:
    """Draw a measure over the tests: pooled median and quartiles, each seed's, and their interval.

    Without trials the medians over seeds, without quartiles.
    """
    seeds = of_seeds(group, measure)
    quartiles = np.tile(np.median(seeds, axis=0), (3, 1))
    if group.has_trials:
        quartiles = over_training(group, values)
    draw_quartiles(axes, quartiles, group, offset, seeds)
    for of_seed in seeds if len(seeds) > 1 and len(group.iterations) >= LEAST_JOINED else ():
        axes.plot(group.iterations, of_seed, color=colour_of(group), lw=0.6, alpha=0.7, zorder=1)
