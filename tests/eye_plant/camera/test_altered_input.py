"""What one eye gets that the other does not: rotated cameras, stereograms, changes amid a run."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from eye_plant.camera.blur import Blur
from eye_plant.camera.config import RENDERERS, CameraConfig
from eye_plant.stereo_camera import StereoCamera
from eye_plant.stimuli.stereograms import Stereogram
from eye_plant.stimuli.stimulus_set import StimulusSet
from eye_plant.vergence import desired_vergence_deg
from tests.eye_plant.rotations import rotation, turned_inward

POSITIONS_M = np.array([[0.0, 0.028, 1.7], [0.0, -0.028, 1.7]])
AHEAD = np.stack([np.eye(3), np.eye(3)])
NOISE, STEREO = 0, 1
PARALLAX = 0.004  # of the plane's 3 m


def spot(column_share: float) -> np.ndarray:
    """A white Gaussian spot at mid height, its place along the row as a share of the width."""
    size_px = 1500
    x = np.arange(size_px) + 0.5
    across = np.exp(-0.5 * ((x - column_share * size_px) / 12.0) ** 2)
    down = np.exp(-0.5 * ((x - 0.5 * size_px) / 12.0) ** 2)
    return np.rint(255.0 * np.outer(down, across)).astype(np.uint8)


def column_px(picture: np.ndarray) -> float:
    """The spot's column, from the picture's centre."""
    x = np.arange(picture.shape[1]) - (picture.shape[1] - 1) / 2.0
    weights = np.where(picture > 40, picture, 0).astype(float).sum(axis=0)
    return float((weights * x).sum() / weights.sum())


@pytest.fixture(scope="module")
def stimuli() -> StimulusSet:
    coarse = np.random.default_rng(0).integers(0, 256, (160, 160), dtype=np.uint8)
    noise = cv2.resize(coarse, (960, 960), interpolation=cv2.INTER_CUBIC)
    stereo = Stereogram(spot(0.5 + PARALLAX / 2), spot(0.5 - PARALLAX / 2), PARALLAX)
    return StimulusSet((noise,), (), (stereo,))


@pytest.fixture(scope="module", params=RENDERERS)
def plain(request):
    return CameraConfig(renderer=request.param)


@pytest.fixture(scope="module")
def camera(plain, stimuli):
    camera = StereoCamera(plain, stimuli, 1.7)
    yield camera
    camera.close()


def seen(camera, i_stimulus=NOISE, rotations=AHEAD, distance_m=2.0):
    return camera.render(POSITIONS_M, rotations, i_stimulus, distance_m)


def all_seen(camera):
    return np.stack((seen(camera, NOISE), seen(camera, STEREO)))


# The nose is on the left eye's right.
@pytest.mark.parametrize(
    ("changes", "eyes"),
    [
        ({"left_rotation_deg": 3.0, "right_rotation_deg": 10.0}, turned_inward(3.0, 10.0)),
        (
            {"left_elevation_deg": 4.0, "right_roll_deg": 4.0},
            np.stack((rotation(upward_deg=4.0), rotation(clockwise_deg=-4.0))),
        ),
        (
            {"left_roll_deg": 4.0, "right_elevation_deg": 4.0},
            np.stack((rotation(clockwise_deg=4.0), rotation(upward_deg=4.0))),
        ),
    ],
)
def test_a_turned_camera_sees_what_such_an_eye_would(camera, plain, changes, eyes):
    straight = seen(camera).astype(int)
    expected = seen(camera, rotations=eyes).astype(int)
    camera.reconfigure(replace(plain, **changes))
    found = seen(camera).astype(int)
    camera.reconfigure(plain)
    assert np.abs(found - expected).max() <= 1
    assert (np.abs(found - straight).max(axis=(1, 2)) > 20).all()


def test_a_camera_turns_with_its_eye(camera, plain):
    """Rotated inward in an eye that looks as far outward, it looks straight ahead."""
    straight = seen(camera).astype(int)
    camera.reconfigure(replace(plain, right_rotation_deg=10.0))
    found = seen(camera, rotations=turned_inward(0.0, -10.0)).astype(int)
    camera.reconfigure(plain)
    assert np.abs(found - straight).max() <= 1


def test_a_stereogram_shows_each_eye_its_own_picture_where_rays_say(camera):
    # The left eye's spot is PARALLAX / 2 of 3 m right of the middle, the eye 28 mm left of it.
    left, right = (column_px(picture) for picture in seen(camera, STEREO))
    shift_m = PARALLAX * 3.0 / 2.0
    assert left == pytest.approx(257.34 * (0.028 + shift_m) / 2.0, abs=0.1)
    assert right == pytest.approx(-257.34 * (0.028 + shift_m) / 2.0, abs=0.1)


def test_eyes_that_converge_as_desired_see_a_stereogram_in_their_centres(camera):
    assert camera.parallax_m(STEREO) == pytest.approx(0.012)
    assert camera.parallax_m(NOISE) == 0.0
    inward_deg = desired_vergence_deg(2.0, 0.056, camera.parallax_m(STEREO)) / 2.0
    pictures = seen(camera, STEREO, turned_inward(inward_deg, inward_deg))
    assert [column_px(picture) for picture in pictures] == pytest.approx([0.0, 0.0], abs=0.1)


def test_a_stereogram_does_not_change_what_follows(camera):
    before = seen(camera)
    seen(camera, STEREO)
    assert (seen(camera) == before).all()


@pytest.mark.parametrize(
    ("roi_px", "changes"),
    [
        (128, {"left_blur_px": 240.0}),
        (320, {"left_horizontal_blur_px": 33.0, "right_vertical_blur_px": 33.0}),
        (128, {"right_blur_px": 1.5}),
        (320, {"right_magnification": 1.15}),
        (128, {"left_occluded": True}),
        (320, {"right_rotation_deg": 10.0, "plane_size_m": 2.0, "focal_length_px": 300.0}),
    ],
)
def test_reconfigured_is_as_made_anew(plain, stimuli, roi_px, changes):
    small = replace(plain, roi_width_px=roi_px, roi_height_px=min(roi_px, 240))
    altered = replace(small, **changes)
    before, anew = StereoCamera(small, stimuli, 1.7), StereoCamera(altered, stimuli, 1.7)
    small_pictures, altered_pictures = all_seen(before), all_seen(anew)
    anew.close()
    before.reconfigure(altered)
    assert (all_seen(before) == altered_pictures).all()
    before.reconfigure(small)
    assert (all_seen(before) == small_pictures).all()
    before.close()


def test_blur_along_one_axis_is_that_eyes_alone(camera, plain):
    sharp = seen(camera)
    camera.reconfigure(replace(plain, right_vertical_blur_px=33.0, right_blur_px=2.0))
    found = seen(camera)
    camera.reconfigure(plain)
    assert (found[0] == sharp[0]).all()
    expected = Blur((320, 240), (320, 240), (2.0, np.hypot(2.0, 33.0)))(sharp[1])
    assert (found[1] == expected).all()


def test_blurs_up_to_the_pictures_size_are_drawn():
    assert CameraConfig(left_blur_px=320.0).blurs_px == ((320.0, 320.0), (0.0, 0.0))
