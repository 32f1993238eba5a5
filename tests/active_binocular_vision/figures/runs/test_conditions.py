"""Errors by distance and start are read back from the picture."""

import numpy as np
import pytest

from active_binocular_vision import Run, groups_of
from active_binocular_vision.figures.runs.conditions import conditions_figure


def test_conditions_show_the_median_of_their_trials(runs: list[Run]) -> None:
    figure = conditions_figure(groups_of(runs))
    axes = figure.axes[0]
    mask = np.ma.getmaskarray(np.ma.asarray(axes.images[0].get_array()))
    assert mask.shape == (7, 10)
    assert (~mask).sum() == 39
    trials = runs[0].tests[400]
    start_deg = np.round(trials.vergence_error_deg[:, 0])
    here = (trials.object_distance_m == 2.0) & (start_deg == -1.0)
    expected = np.median(np.abs(trials.vergence_error_deg[here, -1]))
    row = [label.get_text() for label in axes.get_yticklabels()].index("2")
    column = [label.get_text() for label in axes.get_xticklabels()].index("-1")
    values = np.asarray(axes.images[0].get_array())
    assert values[row, column] == pytest.approx(expected)
    assert f"{expected:.2f}" in {text.get_text() for text in axes.texts}
