"""What both eyes see, with either renderer, against a pinhole camera worked out ray by ray."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import cv2
import numpy as np
import pytest

from eye_plant.camera.config import RENDERERS, CameraConfig
from eye_plant.stereo_camera import StereoCamera
from eye_plant.stimuli.stimulus_set import StimulusSet
from eye_plant.vergence import desired_vergence_deg, disparity_px
from lockstep.errors import InputError
from tests.eye_plant.rotations import rotation, turned_inward

BASELINE_M = 0.056
EYE_HEIGHT_M = 1.7
POSITIONS_M = np.array([[0.0, 0.028, EYE_HEIGHT_M], [0.0, -0.028, EYE_HEIGHT_M]])
FOCAL_LENGTH_PX = 257.34
SIZE_PX = 1920
DISTANCES_M = (0.5, 1.0, 2.0, 4.0, 6.0)

# Numbers of the stimuli.
FLAT = {grey: i for i, grey in enumerate((0, 1, 77, 128, 254, 255))}
MARK = {distance_m: len(FLAT) + i for i, distance_m in enumerate(DISTANCES_M)}
QUADRANTS = len(FLAT) + len(MARK)
NOISE = QUADRANTS + 1


def spot(distance_m: float) -> np.ndarray:
    """A bright Gaussian spot on black, four camera pixels wide when seen from distance_m."""
    width_px = 4.0 * distance_m / FOCAL_LENGTH_PX / CameraConfig().plane_size_m * SIZE_PX
    profile = np.exp(-0.5 * ((np.arange(SIZE_PX) - 0.5 * (SIZE_PX - 1)) / width_px) ** 2)
    return np.rint(255.0 * np.outer(profile, profile)).astype(np.uint8)


@pytest.fixture(scope="module")
def stimuli() -> StimulusSet:
    flat = tuple(np.full((64, 64), grey, np.uint8) for grey in FLAT)
    marks = tuple(spot(distance_m) for distance_m in MARK)
    quadrants = np.kron(np.array([[200, 150], [100, 50]], np.uint8), np.ones((32, 32), np.uint8))
    coarse = np.random.default_rng(0).integers(0, 256, (240, 240), dtype=np.uint8)
    noise = cv2.resize(coarse, (SIZE_PX, SIZE_PX), interpolation=cv2.INTER_CUBIC)
    return StimulusSet((*flat, *marks), (quadrants, noise))


@pytest.fixture(scope="module", params=RENDERERS)
def plain(request: pytest.FixtureRequest) -> CameraConfig:
    return CameraConfig(renderer=request.param)


@pytest.fixture(scope="module")
def camera(plain: CameraConfig, stimuli: StimulusSet) -> Iterator[StereoCamera]:
    camera = StereoCamera(plain, stimuli, EYE_HEIGHT_M)
    yield camera
    camera.close()


@pytest.fixture
def make_camera(plain: CameraConfig, stimuli: StimulusSet) -> Iterator[Callable[..., StereoCamera]]:
    made: list[StereoCamera] = []

    def make(**changes: Any) -> StereoCamera:
        made.append(StereoCamera(replace(plain, **changes), stimuli, EYE_HEIGHT_M))
        return made[-1]

    yield make
    for camera in made:
        camera.close()


def both(one: np.ndarray) -> np.ndarray:
    return np.stack((one, one))


def converged(vergence_deg: float) -> np.ndarray:
    return turned_inward(vergence_deg / 2.0, vergence_deg / 2.0)


def centroid_px(picture: np.ndarray) -> tuple[float, float]:
    """Position of a spot on black, right of and below the picture's centre."""
    row, column = np.unravel_index(picture[60:180, 100:220].argmax(), (120, 120))
    top, left = int(row) + 60 - 18, int(column) + 100 - 18
    window = picture[top : top + 37, left : left + 37].astype(float)
    window = np.maximum(window - 10.0, 0.0)  # the faint rim is mostly rounding
    offset = np.arange(37)
    total = window.sum()
    return (
        left + (window.sum(axis=0) * offset).sum() / total - 159.5,
        top + (window.sum(axis=1) * offset).sum() / total - 119.5,
    )


# --- geometry


@pytest.mark.parametrize("distance_m", MARK)
@pytest.mark.parametrize("error_deg", [-3.0, -1.5, -0.2, 0.0, 0.2, 1.5, 3.0])
def test_disparity_of_the_centre_point(camera, distance_m, error_deg) -> None:
    vergence_deg = desired_vergence_deg(distance_m, BASELINE_M) - error_deg
    pictures = camera.render(POSITIONS_M, converged(vergence_deg), MARK[distance_m], distance_m)
    (left_px, left_below_px), (right_px, right_below_px) = map(centroid_px, pictures)
    assert left_px - right_px == pytest.approx(disparity_px(error_deg, FOCAL_LENGTH_PX), abs=0.05)
    assert left_px + right_px == pytest.approx(0.0, abs=0.05)
    assert (left_below_px, right_below_px) == pytest.approx((0.0, 0.0), abs=0.05)


def seen_plane_points_m(
    i_eye: int, eye_rotation: np.ndarray, distance_m: float
) -> tuple[np.ndarray, np.ndarray]:
    """Oracle: where each pixel's ray meets the plane's plane, right of and above its centre.

    Two arrays (240, 320) in metres.
    """
    right_px, down_px = np.meshgrid(np.arange(320) - 159.5, np.arange(240) - 119.5)
    in_eye = np.stack((np.full_like(right_px, FOCAL_LENGTH_PX), -right_px, -down_px), axis=-1)
    ray = in_eye @ eye_rotation.T
    point_m = POSITIONS_M[i_eye] + ray * (distance_m / ray[..., :1])
    return -point_m[..., 1], point_m[..., 2] - EYE_HEIGHT_M


POSES = {
    "straight": both(rotation()),
    "converged": converged(6.4),
    "diverged": converged(-4.0),
    "up and down": np.stack((rotation(upward_deg=8.0), rotation(upward_deg=-8.0))),
    "rolled": np.stack((rotation(clockwise_deg=20.0), rotation(clockwise_deg=-20.0))),
    "all": np.stack((rotation(-4.0, 6.0, 10.0), rotation(5.0, -3.0, -15.0))),
}


@pytest.mark.parametrize("pose", POSES)
@pytest.mark.parametrize("distance_m", [2.5, 4.0, 6.0, 9.0])
def test_the_plane_covers_what_rays_say(camera: StereoCamera, pose: str, distance_m: float) -> None:
    black = camera.render(POSITIONS_M, POSES[pose], FLAT[0], distance_m)
    white = camera.render(POSITIONS_M, POSES[pose], FLAT[255], distance_m)
    for i_eye in range(2):
        right_m, up_m = seen_plane_points_m(i_eye, POSES[pose][i_eye], distance_m)
        beyond_edge_m = np.maximum(np.abs(right_m), np.abs(up_m)) - 1.5
        is_clear = np.abs(beyond_edge_m) > 0.02 * distance_m / FOCAL_LENGTH_PX
        covered = black[i_eye] != white[i_eye]
        np.testing.assert_array_equal(covered[is_clear], beyond_edge_m[is_clear] < 0.0)
        assert covered.any()


@pytest.mark.parametrize("pose", POSES)
def test_the_texture_lies_where_rays_say(camera, stimuli, pose) -> None:
    distance_m = 0.8  # 2 stimulus pixels per camera pixel, 4 camera pixels per grain
    for i_eye, picture in enumerate(camera.render(POSITIONS_M, POSES[pose], NOISE, distance_m)):
        right_m, up_m = seen_plane_points_m(i_eye, POSES[pose][i_eye], distance_m)
        column = ((right_m / 3.0 + 0.5) * SIZE_PX - 0.5).astype(np.float32)
        row = ((0.5 - up_m / 3.0) * SIZE_PX - 0.5).astype(np.float32)
        expected = cv2.remap(stimuli.all[NOISE], column, row, cv2.INTER_LINEAR).astype(float)
        assert np.abs(picture - expected).mean() < 0.05 * expected.std()


def test_the_stimulus_is_upright_and_not_mirrored(camera: StereoCamera) -> None:
    pictures = camera.render(POSITIONS_M, POSES["straight"], QUADRANTS, 6.0)
    for picture in pictures:
        corners = [picture[row, column] for row in (80, 160) for column in (120, 200)]
        assert corners == [200, 150, 100, 50]


def test_a_raised_eye_sees_the_mark_lower(camera: StereoCamera) -> None:
    pictures = camera.render(POSITIONS_M, both(rotation(upward_deg=3.0)), MARK[2.0], 2.0)
    for picture in pictures:
        # 257.34 tan(3 deg) = 13.49, below the centre
        assert centroid_px(picture)[1] == pytest.approx(13.49, abs=0.1)


def test_an_eye_rolled_clockwise_sees_the_mark_turn_the_other_way(camera: StereoCamera) -> None:
    # Turned 5 deg to its left and then rolled, an eye has the mark 22.5 px right of the centre;
    # rolling it by 10 deg clockwise takes that counter-clockwise, up by 22.5 sin(10 deg).
    eye = rotation(leftward_deg=5.0, clockwise_deg=10.0)
    positions_m = np.array([[0.0, 0.0, EYE_HEIGHT_M]] * 2)
    right_px, down_px = centroid_px(camera.render(positions_m, both(eye), MARK[2.0], 2.0)[0])
    assert right_px == pytest.approx(22.51 * np.cos(np.radians(10.0)), abs=0.1)
    assert down_px == pytest.approx(-22.51 * np.sin(np.radians(10.0)), abs=0.1)


# --- light and background


@pytest.mark.parametrize("grey", FLAT)
def test_grey_values_are_unchanged(camera: StereoCamera, grey: int) -> None:
    for pose in ("straight", "all"):
        pictures = camera.render(POSITIONS_M, POSES[pose], FLAT[grey], 1.0)
        assert pictures.dtype == np.uint8
        assert (pictures == grey).all()


def test_eyes_turned_away_see_the_landscape(camera: StereoCamera) -> None:
    away = turned_inward(-35.0, -35.0)
    centres = camera.render(POSITIONS_M, away, FLAT[0], 6.0)[:, 56:184, 96:224]
    np.testing.assert_array_equal(
        centres, camera.render(POSITIONS_M, away, FLAT[255], 6.0)[:, 56:184, 96:224]
    )
    for centre in centres:
        tiles = centre.reshape(4, 32, 4, 32)
        assert tiles.std(axis=(1, 3)).min() > 2.0
        assert centre.min() > 0


# --- determinism, errors


def test_pictures_are_a_function_of_the_view(camera, make_camera) -> None:
    other = make_camera()
    first = camera.render(POSITIONS_M, POSES["all"], NOISE, 1.3)
    camera.render(POSITIONS_M, POSES["straight"], FLAT[1], 0.5)
    other.render(POSITIONS_M, POSES["straight"], QUADRANTS, 5.0)
    np.testing.assert_array_equal(camera.render(POSITIONS_M, POSES["all"], NOISE, 1.3), first)
    np.testing.assert_array_equal(other.render(POSITIONS_M, POSES["all"], NOISE, 1.3), first)


def test_pictures_share_no_memory(camera: StereoCamera) -> None:
    first = camera.render(POSITIONS_M, POSES["straight"], FLAT[77], 1.0)
    camera.render(POSITIONS_M, POSES["straight"], FLAT[128], 1.0)
    assert (first == 77).all()


@pytest.mark.parametrize("i_stimulus", [-1, NOISE + 1])
def test_an_unknown_stimulus_is_refused(camera: StereoCamera, i_stimulus: int) -> None:
    with pytest.raises(InputError, match=rf"stimulus: expected 0 to {NOISE}, got {i_stimulus}"):
        camera.check(i_stimulus, 1.0)
    with pytest.raises(InputError, match="stimulus: expected"):
        camera.render(POSITIONS_M, POSES["straight"], i_stimulus, 1.0)


@pytest.mark.parametrize("distance_m", [0.09, 9.01, -1.0, np.nan, np.inf])
def test_a_distance_out_of_range_is_refused(camera: StereoCamera, distance_m: float) -> None:
    with pytest.raises(InputError, match=r"object_distance_m: expected 0\.1 to 9, got"):
        camera.render(POSITIONS_M, POSES["straight"], 0, distance_m)


# --- region of interest


@pytest.mark.parametrize("size_px", [(128, 128), (40, 40), (320, 128), (128, 240)])
def test_a_region_of_interest_is_the_centre_bit_by_bit(camera, make_camera, size_px) -> None:
    width_px, height_px = size_px
    region = make_camera(roi_width_px=width_px, roi_height_px=height_px)
    top, left = (240 - height_px) // 2, (320 - width_px) // 2
    for pose in POSES.values():
        for distance_m in (0.5, 1.7, 6.0):
            full = camera.render(POSITIONS_M, pose, NOISE, distance_m)
            centre = full[:, top : top + height_px, left : left + width_px]
            seen = region.render(POSITIONS_M, pose, NOISE, distance_m)
            np.testing.assert_array_equal(seen, centre)


def test_a_blurred_region_knows_what_lies_around_it(make_camera) -> None:
    blur = {"left_blur_px": 3.0, "right_blur_px": 40.0}
    full = make_camera(**blur).render(POSITIONS_M, POSES["all"], NOISE, 2.0)
    region = make_camera(roi_width_px=128, roi_height_px=128, **blur)
    seen = region.render(POSITIONS_M, POSES["all"], NOISE, 2.0)
    np.testing.assert_array_equal(seen, full[:, 56:184, 96:224])


# --- altered rearing


@pytest.mark.parametrize("i_eye", [0, 1])
def test_magnification_moves_the_mark_away_from_the_centre(camera, make_camera, i_eye) -> None:
    side = ("left", "right")[i_eye]
    pose = both(rotation(leftward_deg=2.0, upward_deg=2.0))
    plain = camera.render(POSITIONS_M, pose, MARK[2.0], 2.0)
    magnified = make_camera(**{f"{side}_magnification": 1.25}).render(
        POSITIONS_M, pose, MARK[2.0], 2.0
    )
    np.testing.assert_array_equal(magnified[1 - i_eye], plain[1 - i_eye])
    expected = 1.25 * np.array(centroid_px(plain[i_eye]))
    assert centroid_px(magnified[i_eye]) == pytest.approx(expected, abs=0.05)


def test_without_mipmaps_a_far_plane_keeps_the_contrast_of_its_texels(camera, make_camera) -> None:
    """At 6 m a pixel spans two of the noise's greys a side, or shows the one in its centre."""
    view = POSITIONS_M, POSES["straight"], NOISE, 6.0
    centre = np.s_[:, 80:160, 120:200]
    smooth, aliased = (
        c.render(*view)[centre].std() for c in (camera, make_camera(texture_mipmaps=False))
    )
    assert aliased > 2.0 * smooth


@pytest.mark.parametrize("i_eye", [0, 1])
def test_occlusion_blackens_one_eye(camera, make_camera, i_eye) -> None:
    side = ("left", "right")[i_eye]
    plain = camera.render(POSITIONS_M, POSES["straight"], NOISE, 2.0)
    covered = make_camera(**{f"{side}_occluded": True, f"{side}_blur_px": 2.0}).render(
        POSITIONS_M, POSES["straight"], NOISE, 2.0
    )
    assert (covered[i_eye] == 0).all()
    np.testing.assert_array_equal(covered[1 - i_eye], plain[1 - i_eye])
