import cv2
import numpy as np
import pytest

from active_binocular_vision.baselines.registration import registered_deg

FOCAL_PX = 250.0
SIDE_PX = 128


@pytest.fixture(scope="module")
def texture() -> np.ndarray:
    noise = np.random.default_rng(5).normal(size=(200, 200)).astype(np.float32)
    smooth = cv2.GaussianBlur(noise, (0, 0), 2.0)
    return np.clip(128.0 + 50.0 * smooth / smooth.std(), 0, 255).astype(np.uint8)


def window(texture: np.ndarray, right_px: int = 0, down_px: int = 0) -> np.ndarray:
    top, left = 36 + down_px, 36 + right_px
    return texture[top : top + SIDE_PX, left : left + SIDE_PX]


@pytest.mark.parametrize(
    ("right_px", "down_px", "sign"), [(3, 0, (1.0, 0.0)), (-5, 0, (-1.0, 0.0)), (0, 4, (0.0, 1.0))]
)
def test_a_right_eye_that_looks_elsewhere_has_the_error_of_that_angle(
    texture, right_px, down_px, sign
):
    # To the right: both converge too little. Down: the left one is higher.
    found = registered_deg(window(texture), window(texture, right_px, down_px), FOCAL_PX)
    angle = np.degrees(np.arctan(max(abs(right_px), abs(down_px)) / FOCAL_PX))
    np.testing.assert_allclose(found[:2], np.array(sign) * angle, atol=0.02)
    assert abs(found[2]) < 0.1


def test_a_picture_turned_clockwise_is_incyclovergence(texture):
    turn = cv2.getRotationMatrix2D((99.5, 99.5), -2.0, 1.0)  # clockwise in a picture
    turned = cv2.warpAffine(texture, turn, (200, 200))
    found = registered_deg(window(texture), window(turned), FOCAL_PX)
    np.testing.assert_allclose(found, [0.0, 0.0, 2.0], atol=0.05)


def test_pictures_that_do_not_align_show_nothing(texture):
    assert np.isnan(registered_deg(window(texture), window(texture)[::-1], FOCAL_PX)).all()
