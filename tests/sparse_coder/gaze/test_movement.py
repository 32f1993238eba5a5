import cv2
import numpy as np
import pytest

from sparse_coder.gaze.movement import angles_deg, movement, rotation

FOCAL_PX = 250.0


def seen(texture: np.ndarray, turned: np.ndarray):
    """What a camera turned by R sees of a sphere's picture: sampled direction by direction."""
    x, y = np.meshgrid(np.arange(160) - 79.5, np.arange(120) - 59.5)
    there = np.stack([x, y, np.full_like(x, FOCAL_PX)], axis=2) @ turned.T
    right, down = (FOCAL_PX * np.arctan2(there[..., i], there[..., 2]) for i in (0, 1))
    at_x, at_y = ((at + 200.0).astype(np.float32) for at in (right, down))
    return cv2.remap(texture, at_x, at_y, cv2.INTER_LINEAR)


@pytest.fixture
def texture():
    noise = np.random.default_rng(5).normal(size=(400, 400)).astype(np.float32)
    smooth = cv2.GaussianBlur(noise, (0, 0), 3.0)
    return np.uint8(np.clip(128.0 + 50.0 * smooth / smooth.std(), 0, 255))


def test_the_axes_are_right_up_and_clockwise() -> None:
    ahead, right, down = np.eye(3)[2], np.eye(3)[0], np.eye(3)[1]
    aside = rotation(np.array([30.0, 0.0, 0.0])) @ ahead
    np.testing.assert_allclose(aside, 0.5 * right + np.sqrt(0.75) * ahead, atol=1e-12)
    up = rotation(np.array([0.0, 30.0, 0.0])) @ ahead
    np.testing.assert_allclose(up, -0.5 * down + np.sqrt(0.75) * ahead, atol=1e-12)
    rolled = rotation(np.array([0.0, 0.0, 90.0])) @ right
    np.testing.assert_allclose(rolled, down, atol=1e-12)


def test_a_turn_is_one_angle_in_one_direction_whatever_the_size() -> None:
    ahead = rotation(np.array([30.0, 40.0, 7.0]))[:, 2]
    assert np.degrees(np.arccos(ahead[2])) == pytest.approx(50.0)
    assert ahead[0] / -ahead[1] == pytest.approx(30.0 / 40.0)


@pytest.mark.parametrize("turn", [(0.0, 0.0, 0.0), (3.0, -8.0, 2.0), (-60.0, 1.0, -20.0)])
def test_angles_are_the_inverse_of_the_rotation(turn: tuple[float, float, float]) -> None:
    np.testing.assert_allclose(angles_deg(rotation(np.array(turn))), turn, atol=1e-9)


@pytest.mark.parametrize(
    "turn", [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, -1.0, 1.5), (4.0, 3.0, -2.0), (-6.0, 2.0, 1.0)]
)
def test_a_movement_is_found_in_the_pictures(texture, turn: tuple[float, float, float]) -> None:
    begin = rotation(np.array([2.0, -1.0, 3.0]))
    found = movement(
        seen(texture, begin), seen(texture, begin @ rotation(np.array(turn))), FOCAL_PX
    )
    np.testing.assert_allclose(found, turn, atol=0.05)


def test_what_is_not_clear_is_not_a_number(texture) -> None:
    picture, other = seen(texture, np.eye(3)), seen(texture[::-1, ::-1].copy(), np.eye(3))
    for later in (np.full_like(picture, 9), other):
        assert np.isnan(movement(picture, later, FOCAL_PX)).all()


@pytest.mark.parametrize("side_px", [128, 130, 134])
def test_a_picture_of_any_size_that_stays_has_not_moved(side_px: int) -> None:
    # Smooth, so that a wrong first shift is not made up for; 130 would be padded to 135.
    few = np.random.default_rng(0).uniform(100.0, 230.0, (3, 3))
    smooth = cv2.resize(few, (side_px, side_px), interpolation=cv2.INTER_CUBIC)
    picture = np.asarray(np.clip(smooth, 0.0, 255.0), np.uint8)
    found = movement(picture, picture.copy(), 257.34)
    np.testing.assert_allclose(found, 0.0, atol=1e-3)
