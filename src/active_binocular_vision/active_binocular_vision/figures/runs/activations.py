"""What each muscle does, where each has a command of its own."""

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.patches import Patch

from active_binocular_vision.figures.style import (
    GREY,
    LIGHT_GREY,
    SMALLEST_PT,
    WIDTH_IN,
    legend_below,
    new_figure,
    title_panels,
)
from active_binocular_vision.runs.groups import Group
from lockstep import SIDES

# Of the colour scale of activations.
_TICKS, _LEAST_SHOWN = (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2), 1e-3


def activations_figure(group: Group) -> Figure:
    """Return what each muscle does in the last test's trials, over the distance of the object.

    Median activation at the start and at the end of trials, silent ones white, and the share of the
    trials that end with the muscle active: a median of 0 hides muscles that few trials use. group:
    with trials, of commands of their own.
    """
    trials, silent = group.last_trials, group.last_criteria.silent_activation
    distances_m = np.unique(trials.object_distance_m)
    of_muscles = np.stack([trials.column(name) for name in trials.space.names])
    of_distance = [of_muscles[:, trials.object_distance_m == d] for d in distances_m]
    medians = np.stack([np.nanmedian(values[..., [0, -1]], axis=1) for values in of_distance])
    active = np.stack([(values[..., -1] > silent).mean(axis=1) for values in of_distance])
    figure = new_figure(WIDTH_IN, 1.6 + 0.21 * len(of_muscles))
    panels = figure.subplots(1, 3, sharey=True)
    least, most = max(silent, _LEAST_SHOWN), float(medians.max())
    scale = mpl.colors.LogNorm(least, most)
    for axes, shown in zip(panels, medians.transpose(2, 0, 1), strict=False):
        image = _draw(axes, np.where(shown > silent, shown, np.nan), "viridis_r", scale)
    ticks = [tick for tick in _TICKS if least <= tick <= most]
    bar = figure.colorbar(image, ax=panels[:2], label="activation", location="bottom", shrink=0.6)
    bar.set_ticks(ticks, labels=[f"{tick:g}" for tick in ticks])
    bar.minorticks_off()
    percent = mpl.colors.Normalize(0.0, 100.0)
    image = _draw(panels[2], 100.0 * active, "Greys", percent)
    figure.colorbar(image, ax=panels[2], label="share / %", location="bottom", shrink=0.9)
    for axes in panels:
        axes.set_xticks(range(len(distances_m)), [f"{d:g}" for d in distances_m])
        axes.set_xlabel("object distance / m")
    _name_rows(panels[0], trials.space.names)
    n = f"n = {len(group.runs)} seeds, {len(trials.trial):,} trials"
    title_panels(panels, ["median at the start", "median at the end", "active at the end"])
    label = f"silent: {silent:.2g} or less"
    legend_below(
        figure,
        [Patch(fc="white", ec=GREY, label=label), Patch(fc="none", ec="none", label=n)],
    )
    return figure


def _draw(axes: Axes, values: np.ndarray, colours: str, scale: mpl.colors.Normalize) -> AxesImage:
    """Draw values (n_distances, n_muscles), a row for each muscle."""
    image = axes.imshow(
        values.T, cmap=mpl.colormaps[colours].with_extremes(bad="white"), norm=scale, aspect="auto"
    )
    n_columns, n_rows = values.shape
    axes.set_xticks(np.arange(n_columns - 1) + 0.5, minor=True)
    axes.set_yticks(np.arange(n_rows - 1) + 0.5, minor=True)
    axes.grid(which="minor", color=LIGHT_GREY, lw=0.6)
    axes.tick_params(which="minor", length=0)
    axes.axhline(n_rows / len(SIDES) - 0.5, color="black", lw=1.0)
    axes.spines[:].set_visible(True)
    return image


def _name_rows(axes: Axes, names: tuple[str, ...]) -> None:
    labels = [name.replace("_", " ").replace("erior", ".") for name in names]
    axes.set_yticks(range(len(names)), labels, fontsize=SMALLEST_PT)
