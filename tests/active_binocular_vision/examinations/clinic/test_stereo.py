"""The stereo threshold, and which commands are right."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from active_binocular_vision.examinations.clinic.stereo import (
    DISPARITIES_DEG,
    StereoCurve,
    stereo_curve,
    turns_right,
)
from active_binocular_vision.figures.examinations.clinic import stereo_figure
from active_binocular_vision.learners.session import Course
from tests.readable import assert_readable


def _answers(right_by_sign: np.ndarray, n: int = 100) -> np.ndarray:
    """Answers (n_sizes, 2, n, 1), the first ones right, from shares (2, n_sizes)."""
    return (np.arange(n) < np.round(n * right_by_sign.T)[..., None])[..., None]


def _curve(*right: float) -> StereoCurve:
    sizes_deg = np.array([4.0**i for i in range(len(right))])
    return StereoCurve(sizes_deg, _answers(np.array([right, right])))


def test_the_threshold_is_where_the_share_last_rises_through_three_quarters() -> None:
    # 0.75 lies half-way between 0.5 and 1.0: sqrt(4 * 16) on a logarithmic axis.
    assert _curve(1.0, 0.5, 1.0, 1.0).threshold_deg == pytest.approx(8.0)
    assert _curve(0.9, 0.8, 1.0).threshold_deg == pytest.approx(1.0)
    assert _curve(0.9, 0.8, 0.7).threshold_deg is None
    assert _curve(0.0, 0.74, 0.75).threshold_deg == pytest.approx(16.0)


def test_the_figure_has_both_signs_and_what_the_threshold_is_read_from() -> None:
    answers = _answers(np.array([[0.6, 1.0], [0.8, 0.9]]), 10)
    curve = StereoCurve(np.array([1.0, 2.0]), answers)
    figure = stereo_figure(curve)
    shares = [np.asarray(line.get_ydata()) for line in figure.axes[0].lines[:3]]
    np.testing.assert_allclose(shares, [(0.6, 1.0), (0.8, 0.9), (0.7, 0.95)])
    assert_readable(figure)


def _session(fixation_iterations: int, *horizontal_deg: float) -> Any:
    """Return a session in which all eyes take this course."""
    seen_deg = np.zeros((len(horizontal_deg), 3))
    seen_deg[:, 0] = horizontal_deg
    course = Course(seen_deg, seen_deg, np.zeros((len(seen_deg), 2, 3)), np.zeros(12))
    manager = SimpleNamespace(fixation_iterations=fixation_iterations)
    learners = SimpleNamespace(manager=manager)
    looked: list[int] = []

    def look(n_iterations: int) -> Course:
        looked.append(n_iterations)
        return course

    eyes = SimpleNamespace(look=look)
    return SimpleNamespace(learners=learners, n_pictures=2, eyes=lambda *_: eyes, looked=looked)


@pytest.mark.parametrize(
    ("horizontal_deg", "is_right"),
    [((0.5, 0.1), True), ((0.5, -0.7), True), ((0.5, 0.6), False), ((-0.5, -0.6), False)],
)
def test_a_right_command_turns_against_the_error(horizontal_deg, is_right) -> None:
    session = _session(0, *horizontal_deg)
    assert turns_right(session, 0, 1.0, 0.5) is is_right
    assert session.looked == [1]


def test_of_eyes_that_make_saccades_the_command_after_these_counts() -> None:
    session = _session(10, 0.5, 0.4, 0.3, 0.4)
    assert not turns_right(session, 0, 1.0, 0.5)
    assert session.looked == [3]


def test_every_stereogram_distance_and_sign_counts() -> None:
    # These eyes always converge: right if they converged too little.
    curve = stereo_curve(_session(0, 0.5, 0.1), (0.5, 2.0, 6.0))
    assert curve.n_trials == 6
    assert curve.answers.shape == (len(DISPARITIES_DEG), 2, 2, 3)
    assert curve.right.tolist() == [1.0] * len(DISPARITIES_DEG)
