"""Lines of sight over time: measures against hand-made courses, and eyes that move to a command."""

import numpy as np
import pytest

from eye_plant.mechanics.movement import Movement, angles_deg, movements
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from eye_plant.mechanics.oculomotor import Oculomotor


def _course(turn_deg: list[float], interval_s: float) -> Movement:
    """Return a movement about the vertical by so many deg since the beginning."""
    angle = np.radians(turn_deg)
    sight = np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=1)
    return Movement(interval_s * np.arange(len(turn_deg), dtype=np.float64), sight)


def test_amplitude_and_velocity_of_a_course_made_by_hand() -> None:
    # 0, 1, 4, 5, 5.2, 5.2 deg, 10 ms each: 100, 300, 100, 20, 0 deg/s, of which a tenth is 30.
    movement = _course([0.0, 1.0, 4.0, 5.0, 5.2, 5.2], 0.01)
    assert movement.amplitude_deg == pytest.approx(5.2)
    np.testing.assert_allclose(movement.velocity_deg_s, [100.0, 300.0, 100.0, 20.0, 0.0], atol=1e-6)
    assert movement.peak_velocity_deg_s == pytest.approx(300.0)
    assert movement.duration_s == pytest.approx(0.03)


def test_a_slow_beginning_does_not_count_and_an_end_that_never_comes_does() -> None:
    movement = _course([0.0, 0.1, 2.1, 3.1, 4.1], 0.1)
    assert movement.duration_s == pytest.approx(0.3)


def test_eyes_that_stay_have_no_duration() -> None:
    movement = _course([3.0, 3.0, 3.0], 0.1)
    assert (movement.amplitude_deg, movement.duration_s) == (0.0, 0.0)


def test_angles_are_exact_where_they_are_tiny() -> None:
    tiny = np.radians(1e-7)
    assert angles_deg(np.array([1.0, 0.0, 0.0]), np.array([np.cos(tiny), 0.0, np.sin(tiny)])) == (
        pytest.approx(1e-7, rel=1e-6)
    )


@pytest.mark.parametrize("moves", ["simulated", "at_once"])
def test_eyes_end_at_the_equilibrium_of_the_command(moves: str) -> None:
    eyes = Oculomotor(MechanicsConfig(parameter_set="anatomical", moves=moves))
    before = eyes.tonic_activations
    command = eyes.activations_from(0.12, 0.02)
    left, right = movements(eyes, before, command, 2.0, 1000)
    eyes.settle(before)
    np.testing.assert_allclose([left.sight[0], right.sight[0]], eyes.eye_rotations()[..., 0])
    eyes.settle(command)
    ends = eyes.eye_rotations()[..., 0]
    assert left.amplitude_deg == pytest.approx(angles_deg(left.sight[0], ends[0]), rel=0.05)
    # The eyes mirror each other: both adduct.
    assert right.amplitude_deg == pytest.approx(left.amplitude_deg, rel=1e-6)
    assert left.sight[-1][1] == pytest.approx(-right.sight[-1][1])
