"""Where eyes are to look, by hand and as GazeInverse has it."""

import math

import numpy as np
import pytest

from active_binocular_vision.examinations.positions.targets import (
    NINE_POSITIONS_DEG,
    random_targets_deg,
    wanted_angles_deg,
    wanted_gaze_deg,
)
from eye_plant import GazeInverse
from eye_plant.mechanics.model import MechanicsConfig
from lockstep import ALL_MUSCLES, COMMAND_SPACES

POSITIONS_M = np.array([[0.0, 0.03, 1.7], [0.0, -0.03, 1.7]])


def test_the_right_eye_looks_where_the_left_one_does() -> None:
    left_deg, right_deg = wanted_gaze_deg(POSITIONS_M, (0.0, 0.0), 0.5)
    np.testing.assert_allclose(left_deg, (0.0, 0.0), atol=1e-12)
    np.testing.assert_allclose(right_deg, (-math.degrees(math.atan(0.06 / 0.5)), 0.0), atol=1e-12)
    # 45 deg up from the left eye: 1 m above its height; the right eye sees that from farther away.
    left_deg, right_deg = wanted_gaze_deg(POSITIONS_M, (0.0, 45.0), 1.0)
    np.testing.assert_allclose(left_deg, (0.0, 45.0))
    np.testing.assert_allclose(right_deg[1], math.degrees(math.atan(1.0 / math.hypot(1.0, 0.06))))


@pytest.mark.parametrize("target_deg", [(-8.0, 8.0), (8.0, -8.0)])
def test_eyes_with_the_wanted_angles_look_at_the_target(target_deg: tuple[float, float]) -> None:
    inverse = GazeInverse(
        MechanicsConfig(parameter_set="anatomical"),
        COMMAND_SPACES[ALL_MUSCLES],
        np.zeros(12),
        np.ones(12),
    )
    positions_m = np.array([[0.0, 0.028, 1.7], [0.0, -0.028, 1.7]])
    wanted_deg = wanted_angles_deg(wanted_gaze_deg(positions_m, target_deg, 0.5))
    activations = inverse.activations(wanted_deg, 0.5, np.zeros(12))
    np.testing.assert_allclose(inverse.gaze_deg(activations, 0.5)[:3], 0.0, atol=1e-5)
    np.testing.assert_allclose(inverse.left_gaze_deg(activations), target_deg, atol=1e-4)


def test_random_targets_are_the_same_for_all_and_within_ten_degrees() -> None:
    targets_deg = random_targets_deg(40)
    np.testing.assert_array_equal(targets_deg[:7], random_targets_deg(7))
    assert np.abs(targets_deg).max() <= 10.0
    assert (np.abs(targets_deg) > 8.0).any(axis=0).all()


def test_nine_positions_go_row_by_row() -> None:
    assert NINE_POSITIONS_DEG.tolist()[:4] == [[-8, 8], [0, 8], [8, 8], [-8, 0]]
    assert len(NINE_POSITIONS_DEG) == 9
