"""What drives the learning: pictures that match encode better."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import FixedLocator, FormatStrFormatter, NullFormatter

from experiment_manager.anaglyph import anaglyph
from experiment_manager.analysis.recorded_run import RecordedRun, RecordedTest
from experiment_manager.analysis.report.groups import Group
from experiment_manager.analysis.report.performance_figures import new_figure
from lockstep.wire.topics import PICTURES
from sparse_coder.patches import COARSE_WINDOW_PX

_BIN_DEG = 0.25
_RANGE_DEG = 3.25
_LEAST_PER_BIN = 20
_LEAST_START_ERROR_DEG = 0.5


def encoding_figure(groups: Sequence[Group]) -> Figure | None:
    """Return reconstruction error against vergence error, in the first and in the last test.

    groups: of runs whose bags are there. Median and quartiles of E = E_c + E_f in bins of 0.25 deg,
    over all iterations of all trials; bins of less than 20 are left out. None where all are.
    """
    figure = new_figure(3.3 * len(groups) + 0.6, 3.4)
    panels = figure.subplots(1, len(groups), sharex=True, sharey=True, squeeze=False)[0]
    is_drawn = False
    for axes, group in zip(panels, groups, strict=True):
        first, last = group.iterations[0], group.iterations[-1]
        for iteration, colour in {first: "0.5", last: group.colour}.items():
            tests = group.recorded_at(iteration)
            is_drawn |= _draw_binned(axes, tests, colour, f"after {iteration:,} iterations")
        px_deg = group.last_criteria.px_deg
        axes.axvspan(-px_deg, px_deg, color="0.9", lw=0, zorder=0)
        axes.set_title(group.label, fontsize=9)
        axes.set_xlabel("vergence error / deg")
        axes.legend(loc="center", bbox_to_anchor=(0.5, 0.7), fontsize=8)
    if not is_drawn:
        return None
    # Before and after learning E differs by an order of magnitude; its dip must show in both.
    panels[0].set(ylabel="reconstruction error $E$", xlim=(-_RANGE_DEG, _RANGE_DEG), yscale="log")
    panels[0].yaxis.set_major_locator(FixedLocator((0.05, 0.1, 0.2, 0.5, 1.0)))
    panels[0].yaxis.set_major_formatter(FormatStrFormatter("%g"))
    panels[0].yaxis.set_minor_formatter(NullFormatter())
    return figure


def _draw_binned(axes: Axes, tests: Sequence[RecordedTest], colour: str, label: str) -> bool:
    """Draw the bins that have enough; return whether there is one."""
    error_deg = np.concatenate([t.trials.vergence_error_deg.ravel() for t in tests])
    encoding = np.concatenate([t.reconstruction_error.ravel() for t in tests])
    known = ~np.isnan(encoding)
    number = np.round(error_deg[known] / _BIN_DEG).astype(int)
    encoding = encoding[known]
    reach = int(_RANGE_DEG / _BIN_DEG)
    bins = np.arange(-reach, reach + 1)
    quartiles = np.full((len(bins), 3), np.nan)
    for i, k in enumerate(bins):
        if (number == k).sum() >= _LEAST_PER_BIN:
            quartiles[i] = np.quantile(encoding[number == k], (0.25, 0.5, 0.75))
    # Before learning trials stay at their whole degrees: the bins between are empty.
    filled = ~np.isnan(quartiles[:, 1])
    at_deg, quartiles = bins[filled] * _BIN_DEG, quartiles[filled]
    axes.plot(at_deg, quartiles[:, 1], color=colour, marker=".", label=label)
    axes.fill_between(at_deg, quartiles[:, 0], quartiles[:, 2], color=colour, alpha=0.2, lw=0)
    return bool(filled.any())


def _trials_with_pictures(run: RecordedRun, test: RecordedTest) -> dict[int, int]:
    """Return the indices, by trial number, of the trials of a test that can be drawn.

    They start with an error, and their first and last answered pictures are in the bag.
    """
    if not all(run.bag.has(topic) for topic in PICTURES):
        return {}
    left_ns, right_ns = (run.bag.stamps_ns(topic) for topic in PICTURES)
    is_pictured = np.isin(test.stamps_ns[:, [0, -2]], np.intersect1d(left_ns, right_ns)).all(axis=1)
    moves = np.abs(test.trials.vergence_error_deg[:, 0]) > _LEAST_START_ERROR_DEG
    return {int(test.trials.trial[i]): int(i) for i in np.flatnonzero(is_pictured & moves)}


def anaglyph_figure(run: RecordedRun) -> Figure | None:
    """Return anaglyphs at the start and at the end of a trial, in the first and in the last test.

    Of the trials with pictures in both tests and a start error, the one whose last error in the
    last test is the median; None when there is none. Red and cyan fringes are disparity; the frame
    is the coarse scale's window.
    """
    tests = (run.tests[0], run.tests[-1])
    first, last = (_trials_with_pictures(run, test) for test in tests)
    end_deg = np.abs(tests[1].trials.vergence_error_deg[:, -1])
    common = sorted(set(first) & set(last), key=lambda number: (end_deg[last[number]], number))
    if not common:
        return None
    number = common[(len(common) - 1) // 2]
    figure = new_figure(7.0, 5.6)
    rows = figure.subplots(2, 2)
    for axes_row, test, i_trial in zip(rows, tests, (first[number], last[number]), strict=True):
        _draw_trial(axes_row, run, test, i_trial)
    return figure


def _draw_trial(
    axes_row: Sequence[Axes], run: RecordedRun, test: RecordedTest, i_trial: int
) -> None:
    trials = test.trials
    n_answered = trials.n_iterations - 1
    px_deg = run.evaluation_settings.criteria(trials.training_iteration).px_deg
    for axes, iteration in zip(axes_row, (0, n_answered), strict=True):
        stamp_ns = int(test.stamps_ns[i_trial, iteration])
        left, right = (next(run.bag.images(topic, [stamp_ns]))[1] for topic in PICTURES)
        axes.imshow(anaglyph(left, right))
        height, width = left.shape
        corner = ((width - COARSE_WINDOW_PX) / 2 - 0.5, (height - COARSE_WINDOW_PX) / 2 - 0.5)
        axes.add_patch(_frame(corner))
        error_deg = trials.vergence_error_deg[i_trial, iteration]
        axes.set_title(
            f"trained for {trials.training_iteration:,} iterations, after {iteration} commands:\n"
            f"vergence error {error_deg:+.2f} deg ({error_deg / px_deg:+.1f} px)",
            fontsize=8,
        )
        axes.set_axis_off()


def _frame(corner: tuple[float, float]) -> Rectangle:
    side = COARSE_WINDOW_PX
    return Rectangle(corner, side, side, fill=False, edgecolor="white", lw=0.8)
