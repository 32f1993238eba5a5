"""Boxes show the quartiles of the last test."""

import numpy as np

from active_binocular_vision import Run, groups_of
from active_binocular_vision.figures.runs.boxes import box_figure


def test_fig_3_has_a_box_per_model_and_iteration(runs: list[Run]) -> None:
    figure = box_figure(groups_of(runs))
    upper, lower = figure.axes
    assert upper.get_yscale() == "log"
    medians = sorted(
        float(np.asarray(line.get_ydata())[0])
        for line in upper.lines
        if line.get_color() == "black"
    )
    expected = sorted(
        float(np.median(np.abs(run.tests[400].vergence_error_deg[:, k])))
        for run in runs
        for k in (1, 2, 3, 20)
    )
    assert np.allclose(medians, expected)
    assert [text.get_text() for text in lower.get_xticklabels()] == ["1", "2", "3", "20"]
    assert "%" in lower.get_ylabel()
