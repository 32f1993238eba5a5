"""Lambdas are compared where nothing else differs."""

import numpy as np
import pytest

from active_binocular_vision import Run, groups_of
from active_binocular_vision.figures.runs.over_lambda import lambda_figure, over_lambda
from tests.active_binocular_vision.changed_runs import priced


def test_prices_are_compared_where_nothing_else_differs(runs: list[Run]) -> None:
    family = [priced(runs[1], weight, factor) for weight, factor in ((0.2, 2), (0.01, 1))]
    assert over_lambda(groups_of([runs[1], *family[:1]])) == [], "two lambdas are no curve"
    groups = over_lambda(groups_of([*family, runs[1]]))
    assert [group.common.weight for group in groups] == [0.01, 0.08, 0.2]
    assert over_lambda(groups_of([*runs, *family]))[0].model == "M", "M is lambda 0"
    figure = lambda_figure(groups)
    error, reduction, trade = figure.axes
    medians_deg = [
        np.median(np.abs(group.last_trials.vergence_error_deg[:, 20])) for group in groups
    ]
    assert np.allclose(error.lines[0].get_ydata(), medians_deg)
    assert np.allclose(error.lines[0].get_xdata(), [0.01, 0.08, 0.2])
    medians = [np.nanmedian(group.last_trials.cost_reduction(20)) for group in groups]
    assert np.allclose(reduction.lines[0].get_ydata(), 100 * np.array(medians))
    rates_w = [np.median(group.last_trials.metabolic_rate_w[:, 20]) for group in groups]
    assert np.allclose(trade.lines[0].get_xdata(), rates_w)
    assert np.allclose(trade.lines[0].get_ydata(), medians_deg)


def test_a_price_of_0_has_a_place_before_a_break(runs: list[Run]) -> None:
    family = [priced(runs[1], weight, 1) for weight in (0.0, 0.03, 0.3)]
    error, *_ = lambda_figure(over_lambda(groups_of(family))).axes
    assert np.asarray(error.lines[0].get_xdata()) == pytest.approx([0.01, 0.03, 0.3])
    assert [label.get_text() for label in error.get_xticklabels()] == ["0", "0.03", "0.1", "0.3"]
    assert "//" in {text.get_text() for text in error.texts}
