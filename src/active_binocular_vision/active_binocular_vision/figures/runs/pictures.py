"""What drives the learning: pictures that match encode better."""

from collections.abc import Iterator, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from active_binocular_vision.figures.quartiles import colour_of, draw_band, label_of, title_of
from active_binocular_vision.figures.style import (
    GREY,
    label_decades,
    legend_below,
    new_figure,
    panel_grid,
    title_panels,
)
from active_binocular_vision.runs.groups import Group
from active_binocular_vision.runs.recorded import RecordedTest
from active_binocular_vision.runs.run import Run
from experiment_manager import Bag
from experiment_manager.anaglyph import anaglyph
from experiment_manager.measures.metrics import QUARTILES
from lockstep.wire.topics import PICTURES
from sparse_coder.patches import COARSE

_N_COLUMNS = 2
_BIN_DEG = 0.25
_RANGE_DEG = 3.25
_LEAST_PER_BIN = 20
_LEAST_START_ERROR_DEG = 0.5


def encoding_figure(groups: Sequence[Group]) -> Figure | None:
    """Return reconstruction error against vergence error, in the first and in the last test.

    groups: with a test in a bag; a bag may lack the first ones. Median and quartiles of E = E_c +
    E_f in bins of 0.25 deg, over all iterations of all trials; bins of less than 20 are left out.
    None where all are.
    """
    figure, panels = panel_grid(len(groups), _N_COLUMNS, 2.8, share=True)
    is_drawn = False
    for axes, group in zip(panels, groups, strict=True):
        recorded = group.recorded_iterations
        for iteration, colour in {recorded[0]: GREY, recorded[-1]: colour_of(group)}.items():
            is_drawn |= _draw_binned(axes, group.recorded_at(iteration), colour)
        for px_deg in (-group.last_criteria.px_deg, group.last_criteria.px_deg):
            axes.axvline(px_deg, color=GREY, lw=0.8, ls=":")
        axes.set_xlabel("vergence error / deg")
    if not is_drawn:
        return None
    title_panels(panels, [title_of(group) for group in groups])
    # Before and after learning E differs by an order of magnitude; its dip must show in both.
    panels[0].set(ylabel="reconstruction error $E$", xlim=(-_RANGE_DEG, _RANGE_DEG))
    label_decades(panels[0])
    handles = [
        Line2D([], [], color=GREY, marker=".", label="first test"),
        *(
            Line2D([], [], color=colour_of(g), marker=".", label=f"last test, {label_of(g)}")
            for g in groups
        ),
        Line2D([], [], color=GREY, ls=":", lw=0.8, label="1 px"),
    ]
    legend_below(figure, handles)
    return figure


def _draw_binned(axes: Axes, tests: Sequence[RecordedTest], colour: str) -> bool:
    """Draw the bins that have enough; return whether there is one."""
    error_deg = np.concatenate([t.trials.vergence_error_deg.ravel() for t in tests])
    encoding = np.concatenate([t.reconstruction_error.ravel() for t in tests])
    known = ~(np.isnan(encoding) | np.isnan(error_deg))
    number = np.round(error_deg[known] / _BIN_DEG).astype(int)
    encoding = encoding[known]
    reach = int(_RANGE_DEG / _BIN_DEG)
    bins = np.arange(-reach, reach + 1)
    quartiles = np.full((len(bins), 3), np.nan)
    for i, k in enumerate(bins):
        if (number == k).sum() >= _LEAST_PER_BIN:
            quartiles[i] = np.quantile(encoding[number == k], QUARTILES)
    # Before learning trials stay at their whole degrees: the bins between are empty.
    filled = ~np.isnan(quartiles[:, 1])
    at_deg, quartiles = bins[filled] * _BIN_DEG, quartiles[filled]
    draw_band(axes, at_deg, quartiles.T, colour, marker=".")
    return bool(filled.any())


def _trials_with_pictures(bag: Bag, test: RecordedTest) -> dict[int, int]:
    """Return the indices, by trial number, of the trials of a test that can be drawn.

    They start with an error, and their first and last answered pictures are in the bag.
    """
    if not all(bag.has(topic) for topic in PICTURES):
        return {}
    left_ns, right_ns = (bag.stamps_ns(topic) for topic in PICTURES)
    is_pictured = np.isin(test.stamps_ns[:, [0, -2]], np.intersect1d(left_ns, right_ns)).all(axis=1)
    moves = np.abs(test.trials.vergence_error_deg[:, 0]) > _LEAST_START_ERROR_DEG
    return {int(test.trials.trial[i]): int(i) for i in np.flatnonzero(is_pictured & moves)}


def anaglyph_figure(run: Run) -> Figure | None:
    """Return anaglyphs at the start and at the end of a trial, in the first and in the last test.

    Of the trials with pictures in both tests and a start error, the one whose last error in the
    last test is the median; None when there is none. Red and cyan fringes are disparity; the frame
    is the coarse scale's window.
    """
    if run.bag is None or not run.recorded.tests:
        return None
    tests = (run.recorded.tests[0], run.recorded.tests[-1])
    first, last = (_trials_with_pictures(run.bag, test) for test in tests)
    end_deg = np.abs(tests[1].trials.vergence_error_deg[:, -1])
    common = sorted(set(first) & set(last), key=lambda number: (end_deg[last[number]], number))
    if not common:
        return None
    number = common[(len(common) - 1) // 2]
    figure = new_figure(7.0, 6.2)
    rows = figure.subplots(2, 2)
    px_deg = run.evaluation_settings.criteria(tests[1].trials.training_iteration).px_deg
    titles = [
        title
        for of_test, test, i_trial in zip(rows, tests, (first[number], last[number]), strict=True)
        for title in _draw_trial(of_test, run.bag, px_deg, test, i_trial)
    ]
    title_panels(rows.ravel(), titles)
    return figure


def _draw_trial(
    axes_row: Sequence[Axes], bag: Bag, px_deg: float, test: RecordedTest, i_trial: int
) -> Iterator[str]:
    """Draw a trial's start and end; yield the titles of both panels."""
    trials = test.trials
    n_answered = trials.n_iterations - 1
    for axes, iteration in zip(axes_row, (0, n_answered), strict=True):
        stamp_ns = int(test.stamps_ns[i_trial, iteration])
        left, right = (next(bag.images(topic, [stamp_ns]))[1] for topic in PICTURES)
        axes.imshow(anaglyph(left, right))
        height, width = left.shape
        corner = ((width - COARSE.window_px) / 2 - 0.5, (height - COARSE.window_px) / 2 - 0.5)
        axes.add_patch(
            Rectangle(
                corner, COARSE.window_px, COARSE.window_px, fill=False, edgecolor="white", lw=0.8
            )
        )
        error_deg = trials.vergence_error_deg[i_trial, iteration]
        axes.set_axis_off()
        yield (
            f"{trials.training_iteration:,} training iterations, iteration {iteration} of the trial"
            f"\nvergence error {error_deg:+.2f} deg ({error_deg / px_deg:+.1f} px)"
        )
