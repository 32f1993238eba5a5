"""The ray caster against its slow oracle, over random views and settings."""

from typing import Any

import numpy as np
import pytest

from eye_plant.camera.config import CameraConfig
from eye_plant.camera.ray_casting.plane_renderer import PlaneRenderer
from eye_plant.stimuli.noise import octaves_noise
from tests.eye_plant.camera.pinhole import EYE_HEIGHT_M, central, drawn_slowly, random_view

N_VIEWS = 10
SETTINGS: dict[str, dict[str, Any]] = {
    "as in the paper": {},
    "region of interest": {"roi_width_px": 128, "roi_height_px": 128},
    "odd origin": {"roi_width_px": 130, "roi_height_px": 126},
    "magnified": {"left_magnification": 1.25, "right_magnification": 2.0},
    "reduced": {"left_magnification": 0.7, "right_magnification": 0.9},
    "another lens": {"focal_length_px": 150.0, "width_px": 200, "height_px": 220}
    | {"roi_width_px": 200, "roi_height_px": 220},
    "a small plane": {"plane_size_m": 0.4},
    "another landscape": {"landscape_distance_m": 12.0, "landscape_seed": 5},
}


@pytest.fixture(scope="module")
def stimuli() -> list[np.ndarray]:
    random = np.random.default_rng(3)
    detailed = np.clip(128.0 + 40.0 * octaves_noise(random, 1920), 0.0, 255.0).astype(np.uint8)
    return [
        detailed,
        np.ascontiguousarray(detailed[:700, :1111]),
        random.integers(64, 192, (64, 64), dtype=np.uint8),
        np.full((1, 1), 200, np.uint8),
    ]


@pytest.mark.parametrize("changes", SETTINGS.values(), ids=SETTINGS)
def test_pictures_are_those_of_the_slow_oracle(stimuli, changes) -> None:
    config = CameraConfig(**changes)
    renderer = PlaneRenderer(config, EYE_HEIGHT_M, stimuli)
    n_on_seams = 0
    for number in range(N_VIEWS):
        view = random_view(number, len(stimuli), config.landscape_distance_m - 0.1)
        for i_eye, picture in enumerate(renderer.draw(view)):
            slowly = drawn_slowly(config, stimuli[view.i_stimuli[i_eye]], view, i_eye)
            expected, is_seam = (central(whole, *config.drawn_px) for whole in slowly)
            difference = np.abs(picture - expected)
            is_wrong = difference > 0.5 + 1e-3
            assert not (is_wrong & ~is_seam).any(), (number, i_eye)
            n_on_seams += int(is_wrong.sum())
    assert n_on_seams < 1e-3 * N_VIEWS * 2 * picture.size
