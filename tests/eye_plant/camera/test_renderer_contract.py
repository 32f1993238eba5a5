"""What holds with every renderer; and the ray caster's pictures are those of MuJoCo's."""

import copy
import pickle
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace

import cv2
import mujoco
import numpy as np
import pytest

from eye_plant import StimulusSet
from eye_plant.camera.config import MUJOCO, PLANE, RENDERERS, CameraConfig
from eye_plant.camera.mujoco_renderer import MujocoRenderer
from eye_plant.camera.ray_casting.plane_renderer import PlaneRenderer
from eye_plant.camera.renderer import View
from eye_plant.stereo_camera import StereoCamera
from eye_plant.stimuli.noise import octaves_noise
from eye_plant.stimuli.stereograms import Stereogram
from lockstep import InputError
from tests.eye_plant.camera.pinhole import (
    EYE_HEIGHT_M,
    POSITIONS_M,
    central,
    near_outlines,
    plane_of,
    random_view,
)
from tests.eye_plant.opengl import need_opengl
from tests.eye_plant.rotations import rotation, turned_inward
from tests.patience import PATIENCE_S

SIZE_PX = 1920
GREYS = (0, 77, 255)
FLAT = {grey: i for i, grey in enumerate(GREYS)}
NOISE = len(GREYS)
STEREO = NOISE + 1
POSES = {
    "straight": turned_inward(0.0, 0.0),
    "converged": turned_inward(3.2, 3.2),
    "up and down": np.stack((rotation(upward_deg=8.0), rotation(upward_deg=-8.0))),
    "rolled": np.stack((rotation(clockwise_deg=20.0), rotation(clockwise_deg=-20.0))),
    "all": np.stack((rotation(-4.0, 6.0, 10.0), rotation(5.0, -3.0, -15.0))),
}


@pytest.fixture(scope="module")
def stimuli() -> StimulusSet:
    flat = tuple(np.full((64, 64), grey, np.uint8) for grey in GREYS)
    coarse = np.random.default_rng(0).integers(0, 256, (240, 240), dtype=np.uint8)
    noise = cv2.resize(coarse, (SIZE_PX, SIZE_PX), interpolation=cv2.INTER_CUBIC)
    return StimulusSet(flat, (noise,), (Stereogram(noise[:200, :200], noise[200:400, :200]),))


@pytest.fixture(scope="module", params=RENDERERS)
def plain(request: pytest.FixtureRequest) -> CameraConfig:
    if request.param == MUJOCO:
        need_opengl()
    return CameraConfig(renderer=request.param)


@pytest.fixture(scope="module")
def camera(plain: CameraConfig, stimuli: StimulusSet) -> Iterator[StereoCamera]:
    camera = StereoCamera(plain, stimuli, EYE_HEIGHT_M)
    yield camera
    camera.close()


def seen(camera: StereoCamera, pose: str, i_stimulus: int, distance_m: float) -> np.ndarray:
    return camera.render(POSITIONS_M, POSES[pose], i_stimulus, distance_m)


def test_the_plane_covers_what_rays_say(camera, plain) -> None:
    shown = [(pose, distance_m) for pose in POSES for distance_m in (2.5, 4.0, 6.0, 9.0)]
    black = [seen(camera, pose, FLAT[0], distance_m) for pose, distance_m in shown]
    white = [seen(camera, pose, FLAT[255], distance_m) for pose, distance_m in shown]
    for (pose, distance_m), *pictures in zip(shown, black, white, strict=True):
        view = View(POSITIONS_M, POSES[pose], (0, 0), distance_m)
        for i_eye, (dark, bright) in enumerate(zip(*pictures, strict=True)):
            _, is_plane = plane_of(plain, view).hit(plain, view, i_eye)
            is_clear = ~near_outlines(plain, view, i_eye, 0.02)
            np.testing.assert_array_equal((dark != bright)[is_clear], is_plane[is_clear])
            assert is_plane.any()


def test_the_texture_lies_where_rays_say(camera, plain, stimuli) -> None:
    distance_m = 0.8  # 2 stimulus pixels per camera pixel, 4 camera pixels per grain
    for pose, rotations in POSES.items():
        view = View(POSITIONS_M, rotations, (NOISE, NOISE), distance_m)
        for i_eye, picture in enumerate(seen(camera, pose, NOISE, distance_m)):
            uv, _ = plane_of(plain, view).hit(plain, view, i_eye)
            column, row = (uv * SIZE_PX - 0.5).astype(np.float32)
            expected = cv2.remap(stimuli.all[NOISE], column, row, cv2.INTER_LINEAR).astype(float)
            assert np.abs(picture - expected).mean() < 0.05 * expected.std()


@pytest.mark.parametrize("grey", GREYS)
def test_grey_values_are_unchanged(camera, grey) -> None:
    for pose in ("straight", "all"):
        assert (seen(camera, pose, FLAT[grey], 1.0) == grey).all()


def test_eyes_turned_away_see_the_landscape(camera) -> None:
    away = turned_inward(-35.0, -35.0)
    for picture in central(camera.render(POSITIONS_M, away, FLAT[0], 6.0), 128, 128):
        assert picture.reshape(4, 32, 4, 32).std(axis=(1, 3)).min() > 2.0
        assert picture.min() > 0


def test_the_same_view_gives_the_same_bits(camera, plain, stimuli) -> None:
    first = seen(camera, "all", NOISE, 1.3)
    expected = first.copy()
    other = StereoCamera(plain, stimuli, EYE_HEIGHT_M)
    other_first = seen(other, "rolled", STEREO, 0.5)
    assert (other_first[0] != other_first[1]).any()
    assert (seen(other, "all", NOISE, 1.3) == expected).all()
    assert (seen(camera, "rolled", STEREO, 0.5) == other_first).all()
    other.close()
    assert (first == expected).all(), "pictures share no memory"


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda c: pickle.loads(pickle.dumps(c))])
def test_a_copy_draws_the_same_whatever_becomes_of_the_camera(
    camera, plain, copied: Callable[[StereoCamera], StereoCamera]
) -> None:
    expected = seen(camera, "all", STEREO, 1.3)
    other = copied(camera)
    camera.reconfigure(replace(plain, right_magnification=1.5))
    assert (seen(other, "all", STEREO, 1.3) == expected).all()
    other.close()
    camera.reconfigure(plain)
    assert (seen(camera, "all", STEREO, 1.3) == expected).all()


def test_a_region_of_interest_is_the_centre_bit_by_bit(camera, plain) -> None:
    views = [(pose, NOISE, distance_m) for pose in POSES for distance_m in (0.5, 1.7, 6.0)]
    whole = [seen(camera, *view) for view in views]
    for size_px in ((128, 128), (40, 40), (130, 240)):
        width_px, height_px = size_px
        camera.reconfigure(replace(plain, roi_width_px=width_px, roi_height_px=height_px))
        for view, pictures in zip(views, whole, strict=True):
            assert (seen(camera, *view) == central(pictures, *size_px)).all()
    camera.reconfigure(plain)


def test_one_eyes_magnification_leaves_the_other_eyes_picture(camera, plain) -> None:
    sharp = seen(camera, "all", NOISE, 1.3)
    camera.reconfigure(replace(plain, left_magnification=1.25))
    magnified = seen(camera, "all", NOISE, 1.3)
    camera.reconfigure(plain)
    assert (magnified[1] == sharp[1]).all()
    assert (magnified[0] != sharp[0]).any()


@pytest.mark.parametrize(
    "changes",
    [
        {"left_blur_px": 240.0, "right_vertical_blur_px": 33.0, "right_magnification": 1.15},
        {"right_rotation_deg": 10.0, "plane_size_m": 2.0, "focal_length_px": 300.0}
        | {"landscape_seed": 1, "left_occluded": True, "roi_width_px": 128, "roi_height_px": 128},
    ],
)
def test_reconfigured_is_as_made_anew(camera, plain, stimuli, changes) -> None:
    altered = StereoCamera(replace(plain, **changes), stimuli, EYE_HEIGHT_M)
    before, expected = (seen(c, "converged", NOISE, 2.0) for c in (camera, altered))
    altered.close()
    camera.reconfigure(replace(plain, **changes))
    assert (seen(camera, "converged", NOISE, 2.0) == expected).all()
    camera.reconfigure(plain)
    assert (seen(camera, "converged", NOISE, 2.0) == before).all()


# --- the two renderers


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"left_magnification": 1.25, "right_magnification": 0.8, "landscape_distance_m": 12.0},
        {"focal_length_px": 150.0, "width_px": 200, "height_px": 220, "plane_size_m": 1.0}
        | {"roi_width_px": 128, "roi_height_px": 128, "landscape_seed": 5},
    ],
)
def test_pictures_are_those_of_mujoco(monkeypatch, changes) -> None:
    """Of smooth surfaces, within a grey level on average: each has its own way between levels."""
    need_opengl()
    stimulus, wall = (
        np.clip(
            128.0 + 40.0 * cv2.resize(octaves_noise(np.random.default_rng(seed), 32), size_px),
            *(0.0, 255.0),
        ).astype(np.uint8)
        for seed, size_px in ((1, (1111, 700)), (2, (2600, 800)))
    )
    config = CameraConfig(**changes)
    for module in ("ray_casting.plane_renderer", "mujoco_renderer"):
        monkeypatch.setattr(f"eye_plant.camera.{module}.landscape_picture", lambda _: wall)
    plane, oracle = (
        kind(config, EYE_HEIGHT_M, [stimulus]) for kind in (PlaneRenderer, MujocoRenderer)
    )
    for number in range(12):
        view = random_view(number, 1, config.landscape_distance_m - 0.1)
        pictures = zip(plane.draw(view), oracle.draw(view), strict=True)
        for i_eye, (found, expected) in enumerate(pictures):
            is_inside = ~near_outlines(config, view, i_eye, 2.0)
            difference = np.abs(found.astype(float) - expected)
            mean = difference[central(is_inside, *config.drawn_px)].mean()
            assert mean <= 1.0, (number, i_eye)
    oracle.close()


def test_opengl_that_does_not_work_is_named_when_it_would_draw(monkeypatch, stimuli) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise ImportError("no display")

    monkeypatch.setattr(mujoco, "Renderer", refuse)
    camera = StereoCamera(CameraConfig(renderer=MUJOCO), stimuli)
    with pytest.raises(InputError, match=r"ImportError: no display.*MUJOCO_GL=egl.* libegl1"):
        seen(camera, "straight", NOISE, 1.0)


NO_OPENGL = """
from pathlib import Path
from eye_plant.config import EyePlantConfig
from eye_plant.episode import Episode
from eye_plant.plant import EyePlant
from eye_plant.stimuli.stimulus_set import StimulusSet
import numpy as np, sys

plant = EyePlant(EyePlantConfig(), StimulusSet((np.zeros((8, 8), np.uint8),), ()))
observation = plant.begin(Episode.alone(0, 1.0, np.zeros(12), n_iterations=2))
assert observation.pictures is not None
assert not {"OpenGL", "glfw"} & set(sys.modules)
assert not any(name in Path("/proc/self/maps").read_text() for name in ("libGL", "libEGL"))
"""


def test_the_default_needs_no_opengl(monkeypatch) -> None:
    assert CameraConfig().renderer == PLANE
    monkeypatch.setenv("MUJOCO_GL", "disable")
    subprocess.run([sys.executable, "-c", NO_OPENGL], check=True, timeout=PATIENCE_S)
