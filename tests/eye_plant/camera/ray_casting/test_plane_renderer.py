"""The ray caster against MuJoCo's renderer, which is its oracle, over random views and settings."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import cv2
import numpy as np
import pytest

from eye_plant.camera.config import MUJOCO, PLANE, CameraConfig
from eye_plant.camera.renderer import shows_reduced
from eye_plant.stereo_camera import StereoCamera
from eye_plant.stimuli.noise import octaves_noise
from eye_plant.stimuli.stimulus_set import StimulusSet
from tests.eye_plant.rotations import rotation

EYE_HEIGHT_M = 1.7
N_POSES = 60
STIMULUS_SIZES_PX = ((1920, 1920), (1111, 700), (64, 64), (1, 1))  # width, height
# Of eleven settings, each with N_POSES random poses, distances and stimuli.
SETTINGS: dict[str, dict[str, Any]] = {
    "as in the paper": {},
    "region of interest": {"roi_width_px": 128, "roi_height_px": 128},
    "odd origin": {"roi_width_px": 130, "roi_height_px": 126},
    "magnified": {"left_magnification": 1.25, "right_magnification": 2.0},
    "reduced": {"left_magnification": 0.7, "right_magnification": 0.9},
    "blurred": {"left_blur_px": 3.0, "roi_width_px": 128, "roi_height_px": 128},
    "occluded": {"right_occluded": True},
    "another lens": {"focal_length_px": 150.0, "width_px": 200, "height_px": 220}
    | {"roi_width_px": 200, "roi_height_px": 220},
    "a small plane": {"plane_size_m": 0.4},
    "aliased": {"texture_mipmaps": False},
    "another landscape": {"landscape_distance_m": 12.0, "landscape_seed": 5},
}


@pytest.fixture(scope="module")
def stimuli() -> StimulusSet:
    random = np.random.default_rng(3)
    fractal = octaves_noise(random, 1920)
    detailed = np.clip(128.0 + 40.0 * fractal, 0.0, 255.0).astype(np.uint8)
    return StimulusSet(
        (detailed, np.ascontiguousarray(detailed[:700, :1111])),
        (random.integers(64, 192, (64, 64), dtype=np.uint8), np.full((1, 1), 200, np.uint8)),
    )


@pytest.fixture(params=SETTINGS)
def config(request: pytest.FixtureRequest) -> CameraConfig:
    return replace(CameraConfig(), **SETTINGS[request.param])


@pytest.fixture
def cameras(config, stimuli) -> Iterator[tuple[StereoCamera, StereoCamera]]:
    mujoco, plane = (
        StereoCamera(replace(config, renderer=renderer), stimuli, EYE_HEIGHT_M)
        for renderer in (MUJOCO, PLANE)
    )
    yield mujoco, plane
    mujoco.close()
    plane.close()


@dataclass(frozen=True)
class RandomView:
    """Arguments of StereoCamera.render, by name."""

    eye_positions_m: np.ndarray
    eye_rotations: np.ndarray
    i_stimulus: int
    distance_m: float


def random_view(number: int, n_stimuli: int, farthest_m: float) -> RandomView:
    random = np.random.default_rng((17, number))
    positions_m = np.array([[0.0, 0.028, EYE_HEIGHT_M], [0.0, -0.028, EYE_HEIGHT_M]])
    angles_deg = random.uniform(-1.0, 1.0, (2, 3)) * random.choice([1.0, 10.0, 25.0])
    return RandomView(
        positions_m + random.normal(0.0, 0.01, (2, 3)),
        np.stack([rotation(*angles) for angles in angles_deg]),
        int(random.integers(n_stimuli)),
        float(np.exp(random.uniform(np.log(0.2), np.log(farthest_m)))),
    )


def seams(config: CameraConfig, view: RandomView, i_eye: int, shape: tuple[int, ...]) -> np.ndarray:
    """Return which pixels of one eye, (height, width), lie where two things meet exactly.

    Either two surfaces, within 0.02 px, or two mip-map levels, within a thousandth of an octave.
    Worked out ray by ray for the whole picture and then cut to the region of interest.
    """
    found = np.zeros((config.height_px, config.width_px), bool)
    plane_m = view.distance_m, config.plane_size_m, config.plane_size_m
    landscape_m = (config.landscape_distance_m, config.landscape_width_m, config.landscape_height_m)
    for surface_m, texture_px in (
        (plane_m, drawn_size_px(config, view)),
        (landscape_m, (2600, 800)),
    ):
        uv, _ = texture_coordinates(config, view, i_eye, surface_m, (0.0, 0.0))
        around = [
            texture_coordinates(config, view, i_eye, surface_m, shift_px)[1]
            for shift_px in ((0.02, 0.0), (-0.02, 0.0), (0.0, 0.02), (0.0, -0.02))
        ]
        found |= np.any(around, axis=0) & ~np.all(around, axis=0)
        texels = uv * np.array(texture_px)[:, None, None]
        # Steps from the lower left pixel of each block of two by two.
        start = texels[:, 1::2, 0::2]
        right, up = texels[:, 1::2, 1::2] - start, texels[:, 0::2, 0::2] - start
        octave = 0.5 * np.log2(np.maximum((right**2).sum(axis=0), (up**2).sum(axis=0)))
        between = np.abs(octave - 0.5 - np.round(octave - 0.5)) < 1e-3
        found |= np.kron(between, np.ones((2, 2), bool))
    # Of blur, which carries them about.
    reach_px = 2 * math.ceil(3.0 * max(config.blurs_px[i_eye])) + 1
    found = cv2.dilate(found.astype(np.uint8), np.ones((reach_px, reach_px))).astype(bool)
    top, left = (config.height_px - shape[0]) // 2, (config.width_px - shape[1]) // 2
    return found[top : top + shape[0], left : left + shape[1]]


def texture_coordinates(
    config: CameraConfig,
    view: RandomView,
    i_eye: int,
    surface_m: tuple[float, float, float],
    shift_px: tuple[float, float],
) -> tuple[np.ndarray, np.ndarray]:
    """Return where each pixel's ray meets a surface, (2, height, width) from 0 to 1, and whether.

    surface_m: distance, width and height; shift_px: right and down, of all rays.
    """
    column, row = np.meshgrid(np.arange(config.width_px), np.arange(config.height_px))
    right_px = column - (config.width_px - 1) / 2 + shift_px[0]
    down_px = row - (config.height_px - 1) / 2 + shift_px[1]
    focal_px = config.focal_length_px * config.magnifications[i_eye]
    in_eye = np.stack((np.full(column.shape, focal_px), -right_px, -down_px), axis=-1)
    ray = in_eye @ view.eye_rotations[i_eye].T
    position_m = view.eye_positions_m[i_eye]
    distance_m, width_m, height_m = surface_m
    point_m = position_m + ray * ((distance_m - position_m[0]) / ray[..., :1])
    uv = np.stack(
        (0.5 - point_m[..., 1] / width_m, 0.5 - (point_m[..., 2] - EYE_HEIGHT_M) / height_m)
    )
    return uv, (np.abs(uv - 0.5) <= 0.5).all(axis=0) & (ray[..., 0] > 0.0)


def drawn_size_px(config: CameraConfig, view: RandomView) -> tuple[int, ...]:
    """Return width and height of the copy of the stimulus that suits the distance."""
    size_px = STIMULUS_SIZES_PX[view.i_stimulus]
    if shows_reduced(config, max(size_px), view.distance_m):
        return tuple(max(1, round(px / np.sqrt(2.0))) for px in size_px)
    return size_px


def test_pictures_are_those_of_mujoco(config, cameras) -> None:
    mujoco, plane = cameras
    means, n_on_seams = [], 0
    for number in range(N_POSES):
        view = random_view(number, mujoco.n_stimuli, config.landscape_distance_m - 0.1)
        expected, actual = (c.render(**vars(view)).astype(int) for c in (mujoco, plane))
        difference = np.abs(expected - actual)
        means.append(difference.mean())
        for i_eye in np.flatnonzero((difference > 1).any(axis=(1, 2))):
            is_seam = seams(config, view, int(i_eye), expected.shape[1:])
            assert difference[i_eye][~is_seam].max() <= 1, (number, i_eye)
            n_on_seams += int(np.count_nonzero(difference[i_eye] > 1))
    assert np.mean(means) <= 0.25
    assert n_on_seams < 1e-3 * N_POSES * expected.size
