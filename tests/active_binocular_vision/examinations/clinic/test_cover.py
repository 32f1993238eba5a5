"""The cover test: measures of a course computed by hand."""

import math

import numpy as np
import pytest

from active_binocular_vision.examinations.clinic.cover import (
    CoverTrial,
    cover_trial,
    deviation_of,
    first_lasting,
    turned_deg,
)
from active_binocular_vision.examinations.contract.declared import CoverOptions
from active_binocular_vision.learners.session import Course


@pytest.mark.parametrize(
    ("holds", "first"),
    [([1, 1], 0), ([0, 1, 0, 1, 1], 3), ([0, 0, 1], 2), ([1, 1, 0], math.inf)],
)
def test_the_first_moment_from_which_on_something_holds(holds, first) -> None:
    assert first_lasting(np.array(holds, dtype=bool)) == first


def _course(seen_deg: list[tuple[float, float, float]], sights: list[float]) -> Course:
    """Return a course; sights: angle in deg by which the left eye looks aside."""
    seen = np.array(seen_deg)
    angles = np.radians(sights)
    left = np.stack([np.cos(angles), np.sin(angles), np.zeros(len(angles))], axis=1)
    right = np.broadcast_to((1.0, 0.0, 0.0), left.shape)
    return Course(seen, seen, np.stack([left, right], axis=1), np.zeros(12))


def test_deviations_have_the_signs_of_the_clinic() -> None:
    # Too little convergence: exo. The left eye higher: hyper of the left, hypo of the right one.
    course = _course([(1.0, 2.0, 3.0)], [0.0])
    np.testing.assert_array_equal(deviation_of(course, "left"), [(-1.0, 2.0, 3.0)])
    np.testing.assert_array_equal(deviation_of(course, "right"), [(-1.0, -2.0, 3.0)])


def test_how_far_each_line_of_sight_turns() -> None:
    np.testing.assert_allclose(
        turned_deg(_course([(0.0, 0.0, 0.0)] * 3, [1.0, 9.0, 3.5])), (2.5, 0)
    )


def test_measures_of_a_trial() -> None:
    deviation_deg = np.zeros((7, 3))
    deviation_deg[:, 0] = (0.0, 0.1, 1.0, 2.0, 0.5, 0.1, 0.0)
    trial = CoverTrial(deviation_deg, begin=1, end=3, moved_deg=np.zeros(2))
    assert trial.tropia_deg[0] == 0.1
    assert trial.phoria_deg[0] == 2.0
    assert trial.fused_after(0.2) == 2.0
    assert trial.fused_after(0.05) == 3.0
    assert trial.fused_after(0.0) == math.inf


@pytest.mark.parametrize("kind", ["pair", "gaze"])
def test_a_trial_has_three_parts_of_twenty_iterations(session_with, kind) -> None:
    trial = cover_trial(session_with(kind), 0, 2.0, "left")
    assert (trial.begin, trial.end, len(trial.deviation_deg)) == (20, 40, 61)
    np.testing.assert_allclose(trial.deviation_deg[0], np.zeros(3), atol=2e-3)
    # The pair's eyes move alike.
    if kind == "pair":
        assert trial.moved_deg[0] == pytest.approx(trial.moved_deg[1], abs=1e-6)


def test_eyes_at_rest_that_have_not_learned_keep_their_deviation(session_with) -> None:
    trial = cover_trial(session_with("gaze"), 0, 2.0, "right", CoverOptions(at_rest=True))
    # Both look straight ahead, 56 mm apart: exo by what the object at 2 m needs.
    lines = np.degrees(2.0 * math.atan(0.056 / 2.0 / 2.0))
    np.testing.assert_allclose(trial.deviation_deg[:, 0], -lines, atol=0.01)
    assert trial.fused_after(0.2226) == math.inf


def test_eyes_begin_as_training_left_them_and_the_cover_goes_from_one_to_the_other(
    session_with,
) -> None:
    session = session_with("gaze")
    options = CoverOptions(at_habit=True, alternate=True)
    trial = cover_trial(session, 0, 2.0, "left", options)
    assert (trial.begin, trial.end, len(trial.deviation_deg)) == (40, 60, 81)
    left = session.learners.left
    assert len(left) == 12
    assert session.eyes_as_left(0, 2.0).activations == pytest.approx(left)
    assert session.eyes_at_rest(0, 2.0).activations != pytest.approx(left)
