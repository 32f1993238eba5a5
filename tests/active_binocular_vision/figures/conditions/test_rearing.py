"""Figures of conditions that were reared differently, made up."""

from collections.abc import Callable, Sequence

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.patches import StepPatch

from active_binocular_vision.figures.conditions.rearing import (
    curves_figure,
    histograms_figure,
    landscapes_figure,
    samples_figure,
)
from active_binocular_vision.runs.conditions import Condition, conditions_of
from active_binocular_vision.runs.examined_run import ExaminedRun
from experiment_manager.preparation.profile_paths import profile_files
from tests.active_binocular_vision.made_examined import examined, reared
from tests.readable import assert_readable

Draw = Callable[[Sequence[Condition]], Figure | None]
DRAW: tuple[Draw, ...] = (curves_figure, landscapes_figure, samples_figure, histograms_figure)


def drawn(draw: Draw, *runs: ExaminedRun) -> Figure:
    figure = draw(conditions_of(runs))
    assert figure is not None
    return figure


def test_each_condition_has_a_panel_or_a_row_of_its_name() -> None:
    runs = [reared(name, seed=seed) for name in ("vertical", "own_one") for seed in (1, 2)]
    for draw in (curves_figure, landscapes_figure):
        titles = [axes.get_title("left") for axes in drawn(draw, *runs).axes]
        assert [title.partition("  ")[2] for title in titles] == ["vertical stripes", "own one"]
    draws: tuple[tuple[Draw, int], ...] = ((samples_figure, 2), (histograms_figure, 3))
    for draw_rows, n_columns in draws:
        rows = drawn(draw_rows, *runs).axes[::n_columns]
        assert [axes.get_ylabel() for axes in rows[:2]] == ["vertical\nstripes", "own one"]


def test_the_figures_of_all_conditions_can_be_read() -> None:
    names = [n.rpartition("/")[2] for n in sorted(profile_files()) if n.startswith("rearing/")]
    runs = [reared(name) for name in names]
    for draw in DRAW:
        assert_readable(drawn(draw, *runs))


def test_what_nobody_examined_is_not_drawn() -> None:
    conditions = conditions_of([examined()])
    assert [draw(conditions) for draw in DRAW[1:]] == [None] * 3


def test_normal_eyes_of_the_same_model_are_drawn_beside_a_condition() -> None:
    runs = [
        reared(name, error_deg, model=model)
        for model, errors_deg in (("M", (0.1, 0.3)), ("M_C", (0.2, 0.4)))
        for name, error_deg in zip(("normal", "other"), errors_deg, strict=True)
    ]
    curves = [axes.lines[:2] for axes in drawn(curves_figure, *runs).axes]
    ends = [[np.asarray(line.get_ydata())[-1] for line in lines] for lines in curves]
    assert [of_panel[0] for of_panel in ends] == [0.1, 0.1, 0.2, 0.2]
    assert [ends[1], ends[3]] == [[0.1, 0.3], [0.2, 0.4]]
    # Beside the line at an error of 0.
    n_lines = [len(axes.lines) for axes in drawn(landscapes_figure, *runs).axes]
    assert n_lines == [2, 3, 2, 3]


def test_landscapes_are_shares_of_their_mean_so_that_a_low_one_is_not_flat() -> None:
    low = reared("low", valley=(0.03, 0.01, 0.03))
    for axes in drawn(landscapes_figure, low, reared("high")).axes:
        # 0.6, 0.2 and 0.6 of a mean of 7/15.
        assert axes.lines[0].get_ydata() == pytest.approx([9 / 7, 3 / 7, 9 / 7])
        assert axes.texts[0].get_text() == "depth 0.57"


def test_a_change_of_the_plant_is_marked() -> None:
    axes = drawn(curves_figure, reared("surgery", changed_at=(1000,))).axes[0]
    assert any(np.array_equal(line.get_xdata(), [1000, 1000]) for line in axes.lines)


def test_histograms_are_shares_of_those_that_count() -> None:
    orientation, binocularity, disparity = drawn(histograms_figure, reared(), reared(seed=2)).axes
    for outline in orientation.findobj(StepPatch):
        # Four orientations, 45 deg apart.
        assert outline.get_data()[0] == pytest.approx([25.0, 0.0] * 4)
    for outline in binocularity.findobj(StepPatch):
        assert outline.get_data()[0].sum() == pytest.approx(100.0)
    assert orientation.get_title(loc="right") == "n = 8 and 8"
    assert disparity.get_xlim() == (-4.0, 4.0)
