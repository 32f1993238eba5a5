"""Smaller copies of a stimulus, and which of them is drawn."""

import math

import numpy as np
import pytest

from eye_plant.camera.config import CameraConfig
from eye_plant.camera.mipmaps import mipmap_levels, wants_reduced
from eye_plant.camera.renderer import shows_reduced


@pytest.mark.parametrize(
    ("texels_per_pixel", "expected"),
    [
        (0.3, False),  # magnified: nothing finer than the full size
        (1.0, False),
        (2.0**0.2, False),
        (2.0**0.3, True),
        (math.sqrt(2.0), True),
        (2.0**0.7, True),
        (2.0**0.8, False),
        (4.0, False),
        (4.0 * math.sqrt(2.0), True),
    ],
)
def test_a_level_lies_within_a_quarter_octave(texels_per_pixel: float, expected: bool) -> None:
    assert wants_reduced(texels_per_pixel) == expected
    if texels_per_pixel >= 1.0:
        octave = math.log2(texels_per_pixel / (math.sqrt(2.0) if expected else 1.0))
        assert abs(octave - round(octave)) <= 0.25 + 1e-9


@pytest.mark.parametrize(("distance_m", "expected"), [(0.4, False), (0.5, True), (0.8, False)])
def test_a_stimulus_is_reduced_by_the_texels_in_a_pixel(distance_m: float, expected: bool) -> None:
    # Of 1920 texels on 3 m a pixel spans 640 distance / 257.34: 0.99, 1.24 and 1.99.
    assert shows_reduced(CameraConfig(), 1920, distance_m) == expected


@pytest.mark.parametrize(
    ("shape", "sizes"),
    [((8, 8), [(8, 8), (4, 4), (2, 2), (1, 1)]), ((3, 6), [(3, 6), (1, 3), (1, 1)])],
)
def test_mip_maps_halve_down_to_one_pixel(shape, sizes) -> None:
    levels = mipmap_levels(np.full(shape, 90, np.uint8))
    assert [level.shape for level in levels] == sizes
    assert all((level == 90).all() for level in levels)


def test_a_mip_map_is_the_mean_of_four() -> None:
    picture = np.array([[10, 30, 0, 0], [50, 70, 0, 8]], np.uint8)
    np.testing.assert_array_equal(mipmap_levels(picture)[1], [[40, 2]])
