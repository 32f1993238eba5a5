"""Which copy of a stimulus is drawn."""

import math

import pytest

from eye_plant.camera.textures import GreyTexture

FULL, REDUCED = 3, 4


@pytest.mark.parametrize(
    ("texels_per_pixel", "expected"),
    [
        (0.3, FULL),  # magnified: nothing finer than the full size
        (1.0, FULL),
        (2.0**0.2, FULL),
        (2.0**0.3, REDUCED),
        (math.sqrt(2.0), REDUCED),
        (2.0**0.7, REDUCED),
        (2.0**0.8, FULL),
        (4.0, FULL),
        (4.0 * math.sqrt(2.0), REDUCED),
    ],
)
def test_a_level_lies_within_a_quarter_octave(texels_per_pixel: float, expected: int) -> None:
    texture = GreyTexture(FULL, REDUCED, size_px=1920, channel=0)
    assert texture.name_for(texels_per_pixel) == expected
    if texels_per_pixel >= 1.0:
        sizes = {FULL: 1.0, REDUCED: math.sqrt(2.0)}
        octave = math.log2(texels_per_pixel / sizes[expected])
        assert abs(octave - round(octave)) <= 0.25 + 1e-9
