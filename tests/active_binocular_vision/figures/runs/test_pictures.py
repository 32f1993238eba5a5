"""Figures of what was seen show the numbers of the bag."""

import math
from dataclasses import replace

import numpy as np
import pytest

from active_binocular_vision import Run, groups_of
from active_binocular_vision.figures.runs.pictures import (
    anaglyph_figure,
    encoding_figure,
)
from active_binocular_vision.pages.report.drawings import drawings
from experiment_manager.anaglyph import anaglyph


def test_encoding_is_binned_by_vergence_error(runs: list[Run]) -> None:
    figure = encoding_figure(groups_of(runs[:1]))
    assert figure is not None
    (axes,) = figure.axes
    before, after = (np.asarray(line.get_ydata()) for line in axes.lines[:2])
    at_deg = np.asarray(axes.lines[1].get_xdata())
    test = runs[0].recorded.tests[-1]
    here = np.abs(test.trials.vergence_error_deg[:, :20]) < 0.125
    expected = np.median(test.reconstruction_error[:, :20][here])
    assert after[at_deg == 0.0] == pytest.approx(expected)
    # The fixture encodes better the less the error, once it has learned.
    assert after[at_deg == 0.0] < np.nanmin(before) - 0.1


def test_there_is_no_encoding_of_too_few_observations(runs, monkeypatch) -> None:
    monkeypatch.setattr("active_binocular_vision.figures.runs.pictures._LEAST_PER_BIN", 10**6)
    assert encoding_figure(groups_of(runs)) is None


def _with_a_bag_from_test(run: Run, i_test: int) -> None:
    """Make it a run that was continued from a copied checkpoint, without the bag before it."""
    run.document, run.tests = run.document, run.tests  # of results.json and trials.npz
    run.recorded = replace(run.recorded, tests=run.recorded.tests[i_test:])


def test_a_bag_without_the_first_tests_shows_those_that_it_has(runs: list[Run]) -> None:
    whole, other = runs
    _with_a_bag_from_test(other, 2)
    (_, group) = groups = groups_of(runs)
    assert (group.iterations, group.recorded_iterations) == ([0, 130, 270, 400], [270, 400])
    figure = encoding_figure(groups)
    assert figure is not None
    for axes, run in zip(figure.axes, (whole, other), strict=True):
        test = run.recorded.tests[0]
        here = np.abs(test.trials.vergence_error_deg[:, :20]) < 0.125
        line = axes.lines[0]
        value = np.asarray(line.get_ydata())[np.asarray(line.get_xdata()) == 0.0]
        assert value == pytest.approx(np.median(test.reconstruction_error[:, :20][here]))


def test_a_bag_without_a_test_is_left_out_and_named(runs: list[Run]) -> None:
    for run in runs:
        _with_a_bag_from_test(run, 4)
    found = {drawing.name: drawing for drawing in drawings(groups_of(runs))}
    encoding, anaglyphs = found["encoding"], found["anaglyphs_0_M"]
    assert encoding.draw() is None
    assert encoding.left_out == [run.name for run in runs]
    assert anaglyphs.draw() is None
    assert anaglyphs.lack.startswith("Not drawn without a bag with images")


def test_an_anaglyph_is_red_for_the_left_eye_and_cyan_for_the_right() -> None:
    left, right = np.full((2, 3), 200, np.uint8), np.full((2, 3), 10, np.uint8)
    assert anaglyph(left, right)[1, 2].tolist() == [200, 10, 10]


def test_anaglyphs_show_a_trial_before_and_after_learning(runs: list[Run]) -> None:
    run = runs[0]
    assert run.bag is not None
    tests = run.recorded.tests
    figure = anaglyph_figure(run)
    assert figure is not None
    # Trials 0, 10, 20, 30 have pictures; the last two start without error. Of the others the
    # lower median is the one that ends nearer.
    final_deg = np.abs(tests[-1].trials.vergence_error_deg[:, -1])
    trial = min((0, 10), key=lambda number: final_deg[number])
    for axes, test, iteration in zip(
        figure.axes, (tests[0],) * 2 + (tests[-1],) * 2, (0, 19, 0, 19), strict=True
    ):
        stamp_ns = int(test.stamps_ns[trial, iteration])
        ((_, left),) = run.bag.images("left/image_raw", [stamp_ns])
        ((_, right),) = run.bag.images("right/image_raw", [stamp_ns])
        shown = np.asarray(axes.images[0].get_array())
        assert np.array_equal(shown, anaglyph(left, right))
        error_deg = test.trials.vergence_error_deg[trial, iteration]
        px_deg = math.degrees(math.atan(1 / 257.34))
        assert f"error {error_deg:+.2f} deg ({error_deg / px_deg:+.1f} px)" in axes.get_title(
            "left"
        )


def test_pictures_that_were_not_recorded_are_no_figure(runs, monkeypatch) -> None:
    run = runs[1]
    monkeypatch.setattr(run.bag, "has", lambda topic: False)
    assert anaglyph_figure(run) is None
