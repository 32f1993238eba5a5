"""What both eyes see: poses of eyes and cameras, stereograms, blur, occlusion, magnification."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import cv2
import numpy as np
import pytest

from eye_plant import StimulusSet, desired_vergence_deg
from eye_plant.camera.blur import Blur
from eye_plant.camera.config import CameraConfig
from eye_plant.stereo_camera import StereoCamera
from eye_plant.stimuli.stereograms import Stereogram
from eye_plant.vergence import disparity_px
from lockstep import SIDES, InputError
from tests.eye_plant.camera.pinhole import EYE_HEIGHT_M, POSITIONS_M, central
from tests.eye_plant.rotations import rotation, turned_inward

BASELINE_M = 0.056
FOCAL_LENGTH_PX = 257.34
PARALLAX = 0.004  # of the plane's 3 m
NOISE, SPOT, STEREO = 0, 1, 2
AHEAD = turned_inward(0.0, 0.0)
PLAIN = CameraConfig()


def spot(column_share: float) -> np.ndarray:
    """A white Gaussian spot at mid height, its place along the row as a share of the width."""
    size_px = 1500
    x = np.arange(size_px) + 0.5
    across = np.exp(-0.5 * ((x - column_share * size_px) / 12.0) ** 2)
    down = np.exp(-0.5 * ((x - 0.5 * size_px) / 12.0) ** 2)
    return np.rint(255.0 * np.outer(down, across)).astype(np.uint8)


def place_px(picture: np.ndarray) -> tuple[float, float]:
    """Where the spot is, right of and below the picture's centre; the landscape is not as white."""
    row, column = np.unravel_index(central(picture, 120, 120).argmax(), (120, 120))
    top, left = int(row) + 60 - 18, int(column) + 100 - 18
    window = np.maximum(picture[top : top + 37, left : left + 37].astype(float) - 10.0, 0.0)
    offset = np.arange(37)
    total = window.sum()
    return (
        left + (window.sum(axis=0) * offset).sum() / total - 159.5,
        top + (window.sum(axis=1) * offset).sum() / total - 119.5,
    )


@pytest.fixture(scope="module")
def made() -> Iterator[StereoCamera]:
    coarse = np.random.default_rng(0).integers(0, 256, (160, 160), dtype=np.uint8)
    noise = cv2.resize(coarse, (960, 960), interpolation=cv2.INTER_CUBIC)
    stereo = Stereogram(spot(0.5 + PARALLAX / 2), spot(0.5 - PARALLAX / 2), PARALLAX)
    camera = StereoCamera(PLAIN, StimulusSet((noise,), (spot(0.5),), (stereo,)), EYE_HEIGHT_M)
    yield camera
    camera.close()


@pytest.fixture
def camera(made: StereoCamera) -> StereoCamera:
    """Return a camera that nothing has changed."""
    made.reconfigure(PLAIN)
    return made


def seen(camera, i_stimulus=NOISE, rotations=AHEAD, distance_m=2.0) -> np.ndarray:
    pictures: np.ndarray = camera.render(POSITIONS_M, rotations, i_stimulus, distance_m)
    return pictures


# --- eyes


@pytest.mark.parametrize("distance_m", [1.0, 2.0, 4.0])
@pytest.mark.parametrize("error_deg", [-3.0, -0.2, 0.0, 1.5])
def test_disparity_of_the_centre_point(camera, distance_m, error_deg) -> None:
    inward_deg = (desired_vergence_deg(distance_m, BASELINE_M) - error_deg) / 2.0
    pictures = seen(camera, SPOT, turned_inward(inward_deg, inward_deg), distance_m)
    (left_px, left_below_px), (right_px, right_below_px) = map(place_px, pictures)
    assert left_px - right_px == pytest.approx(disparity_px(error_deg, FOCAL_LENGTH_PX), abs=0.05)
    assert left_px + right_px == pytest.approx(0.0, abs=0.05)
    assert (left_below_px, right_below_px) == pytest.approx((0.0, 0.0), abs=0.05)


def test_a_raised_eye_sees_the_mark_lower(camera) -> None:
    raised = np.stack([rotation(upward_deg=3.0)] * 2)
    for picture in seen(camera, SPOT, raised):
        # 257.34 tan(3 deg) = 13.49, below the centre
        assert place_px(picture)[1] == pytest.approx(13.49, abs=0.1)


def test_an_eye_rolled_clockwise_sees_the_mark_turn_the_other_way(camera) -> None:
    # Turned 5 deg to its left and then rolled, an eye has the mark 22.5 px right of the centre;
    # rolling it by 10 deg clockwise takes that counter-clockwise, up by 22.5 sin(10 deg).
    rolled = np.stack([rotation(leftward_deg=5.0, clockwise_deg=10.0)] * 2)
    positions_m = np.array([[0.0, 0.0, EYE_HEIGHT_M]] * 2)
    right_px, down_px = place_px(camera.render(positions_m, rolled, SPOT, 2.0)[0])
    assert right_px == pytest.approx(22.51 * np.cos(np.radians(10.0)), abs=0.1)
    assert down_px == pytest.approx(-22.51 * np.sin(np.radians(10.0)), abs=0.1)


# --- cameras


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
def test_a_turned_camera_sees_what_such_an_eye_would(camera, changes, eyes) -> None:
    straight = seen(camera).astype(int)
    expected = seen(camera, rotations=eyes).astype(int)
    camera.reconfigure(replace(PLAIN, **changes))
    found = seen(camera).astype(int)
    assert np.abs(found - expected).max() <= 1
    assert (np.abs(found - straight).max(axis=(1, 2)) > 20).all()


def test_a_camera_turns_with_its_eye(camera) -> None:
    """Rotated inward in an eye that looks as far outward, it looks straight ahead."""
    straight = seen(camera).astype(int)
    camera.reconfigure(replace(PLAIN, right_rotation_deg=10.0))
    found = seen(camera, rotations=turned_inward(0.0, -10.0)).astype(int)
    assert np.abs(found - straight).max() <= 1


@pytest.mark.parametrize("i_eye", [0, 1])
def test_magnification_moves_the_mark_away_from_the_centre(camera, i_eye) -> None:
    eyes = np.stack([rotation(leftward_deg=2.0, upward_deg=2.0)] * 2)
    before = seen(camera, SPOT, eyes)[i_eye]
    changes: dict[str, Any] = {f"{SIDES[i_eye]}_magnification": 1.25}
    camera.reconfigure(replace(PLAIN, **changes))
    found = seen(camera, SPOT, eyes)[i_eye]
    expected = 1.25 * np.array(place_px(before))
    assert place_px(found) == pytest.approx(expected, abs=0.05)


# --- stereograms


def test_a_stereogram_shows_each_eye_its_own_picture_where_rays_say(camera) -> None:
    # The left eye's spot is PARALLAX / 2 of 3 m right of the middle, the eye 28 mm left of it.
    (left_px, _), (right_px, _) = map(place_px, seen(camera, STEREO))
    shift_m = PARALLAX * 3.0 / 2.0
    assert left_px == pytest.approx(257.34 * (0.028 + shift_m) / 2.0, abs=0.1)
    assert right_px == pytest.approx(-257.34 * (0.028 + shift_m) / 2.0, abs=0.1)


def test_eyes_that_converge_as_desired_see_a_stereogram_in_their_centres(camera) -> None:
    assert camera.parallax_m(STEREO) == pytest.approx(0.012)
    assert camera.parallax_m(NOISE) == 0.0
    inward_deg = desired_vergence_deg(2.0, BASELINE_M, camera.parallax_m(STEREO)) / 2.0
    pictures = seen(camera, STEREO, turned_inward(inward_deg, inward_deg))
    assert [place_px(p)[0] for p in pictures] == pytest.approx([0.0, 0.0], abs=0.1)


# --- what is done to the pictures


def test_blur_along_one_axis_is_that_eyes_alone(camera) -> None:
    sharp = seen(camera)
    camera.reconfigure(replace(PLAIN, right_vertical_blur_px=33.0, right_blur_px=2.0))
    found = seen(camera)
    assert (found[0] == sharp[0]).all()
    expected = Blur((320, 240), (320, 240), (2.0, np.hypot(2.0, 33.0)))(sharp[1])
    assert (found[1] == expected).all()


def test_a_blurred_region_knows_what_lies_around_it(camera) -> None:
    blurred = replace(PLAIN, left_blur_px=3.0, right_blur_px=40.0)
    camera.reconfigure(blurred)
    whole = seen(camera)
    camera.reconfigure(replace(blurred, roi_width_px=128, roi_height_px=128))
    assert (seen(camera) == central(whole, 128, 128)).all()


@pytest.mark.parametrize("i_eye", [0, 1])
def test_occlusion_blackens_one_eye(camera, i_eye) -> None:
    changes: dict[str, Any] = {f"{SIDES[i_eye]}_occluded": True, f"{SIDES[i_eye]}_blur_px": 2.0}
    before = seen(camera)
    camera.reconfigure(replace(PLAIN, **changes))
    covered = seen(camera)
    assert (covered[i_eye] == 0).all()
    assert (covered[1 - i_eye] == before[1 - i_eye]).all()


# --- what is refused


@pytest.mark.parametrize("i_stimulus", [-1, STEREO + 1])
def test_an_unknown_stimulus_is_refused(camera, i_stimulus) -> None:
    with pytest.raises(InputError, match=rf"stimulus: expected 0 to {STEREO}, got {i_stimulus}"):
        seen(camera, i_stimulus)


@pytest.mark.parametrize("distance_m", [0.09, 9.01, -1.0, np.nan, np.inf])
def test_a_distance_out_of_range_is_refused(camera, distance_m) -> None:
    with pytest.raises(InputError, match=r"object_distance_m: expected 0\.1 to 9, got"):
        seen(camera, distance_m=distance_m)


@pytest.mark.parametrize(
    "stimulus", [np.zeros((8, 8, 3), np.uint8), np.zeros((8, 8)), np.zeros((0, 8), np.uint8)]
)
def test_a_stimulus_of_another_kind_is_refused(stimulus) -> None:
    grey = np.zeros((8, 8), np.uint8)
    with pytest.raises(InputError, match="stimulus 1: expected a grey image"):
        StereoCamera(CameraConfig(), StimulusSet((grey,), (stimulus,)))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"renderer": "vulkan"}, r"renderer: expected plane or mujoco, got 'vulkan'"),
        ({"roi_width_px": 322}, r"roi_width_px: expected width_px, 320, or less, got 322"),
        ({"roi_height_px": 127}, r"roi_height_px: expected a multiple of 2, 2 px or more, got 127"),
        ({"focal_length_px": float("nan")}, r"focal_length_px: expected more than 0 px, got nan"),
        ({"left_magnification": 0.0}, r"left_magnification: expected more than 0, got 0.0"),
        ({"right_blur_px": -1.0}, r"right_blur_px: expected 0 px or more, got -1"),
        ({"left_blur_px": 320.5}, r"left_blur_px: expected 0 to 320, the image's longer side"),
        ({"right_vertical_blur_px": 1000.0}, r"right_vertical_blur_px: expected 0 to 320"),
        ({"right_rotation_deg": 60.0}, r"right_rotation_deg: expected -45 to 45 deg"),
    ],
)
def test_a_configuration_that_cannot_be_drawn_is_refused(changes, message) -> None:
    with pytest.raises(InputError, match=message):
        CameraConfig(**changes)
