"""Turns of eyes and of cameras in them."""

import numpy as np
import pytest

from eye_plant.mechanics.mujoco_model import MechanicsConfig
from eye_plant.mechanics.oculomotor import Oculomotor
from eye_plant.turns import NO_TURNS_DEG, eye_rotations, turned

_STRAIGHT = np.stack([np.eye(3)] * 2)


def test_by_a_right_angle() -> None:
    # Toward the nose: the left eye looks to the right, the right eye to the left.
    left, right = turned(_STRAIGHT, [(90.0, 0.0, 0.0)] * 2)
    np.testing.assert_allclose(left[:, 0], (0.0, -1.0, 0.0), atol=1e-12)
    np.testing.assert_allclose(right[:, 0], (0.0, 1.0, 0.0), atol=1e-12)
    # Up: both look up. Roll: upper poles toward the nose, the lines of sight stay.
    np.testing.assert_allclose(
        turned(_STRAIGHT, [(0.0, 90.0, 0.0)] * 2)[:, :, 0], [(0.0, 0.0, 1.0)] * 2, atol=1e-12
    )
    rolled = turned(_STRAIGHT, [(0.0, 0.0, 90.0)] * 2)
    np.testing.assert_allclose(rolled[:, :, 2], [(0.0, -1.0, 0.0), (0.0, 1.0, 0.0)], atol=1e-12)
    np.testing.assert_allclose(rolled[:, :, 0], [(1.0, 0.0, 0.0)] * 2, atol=1e-12)


def test_without_a_turn_nothing_is_computed() -> None:
    assert turned(_STRAIGHT, NO_TURNS_DEG) is _STRAIGHT


@pytest.mark.parametrize("parameter_set", ["k17", "anatomical"])
def test_angles_of_the_muscles_eyes_give_their_rotations(parameter_set: str) -> None:
    eyes = Oculomotor(MechanicsConfig(parameter_set=parameter_set))
    activations = eyes.tonic_activations
    activations[[0, 3, 5, 8]] += (0.1, 0.05, 0.07, 0.1)
    eyes.settle(activations)
    angles_rad = eyes.state().eye_angles_rad
    assert (np.abs(angles_rad) > 0.01).all()
    np.testing.assert_allclose(eye_rotations(angles_rad), eyes.eye_rotations(), atol=1e-12)
