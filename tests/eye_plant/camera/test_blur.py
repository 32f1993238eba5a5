import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from eye_plant.camera.blur import Blur


@pytest.fixture(scope="module")
def picture():
    return np.random.default_rng(0).integers(0, 256, (240, 320), dtype=np.uint8)


def oracle(picture, deviations_px):
    """The picture blurred by another library; "mirror" does not repeat the outermost pixel."""
    blurred = picture.astype(np.float64)
    for axis, deviation_px in zip((1, 0), deviations_px, strict=True):
        if deviation_px:
            radius = int(np.ceil(3.0 * deviation_px))
            blurred = gaussian_filter1d(blurred, deviation_px, axis, mode="mirror", radius=radius)
    return blurred


@pytest.mark.parametrize(
    "deviations_px", [(2.0, 2.0), (33.0, 0.0), (0.0, 33.0), (240.0, 240.0), (0.3, 7.7), (0, 0)]
)
@pytest.mark.parametrize("kept_px", [(320, 240), (128, 128), (2, 2)])
def test_a_blur_of_any_width_is_a_gaussian_with_a_mirrored_border(picture, deviations_px, kept_px):
    width, height = kept_px
    top, left = (240 - height) // 2, (320 - width) // 2
    expected = oracle(picture, deviations_px)[top : top + height, left : left + width]
    found = Blur((320, 240), kept_px, deviations_px)(picture)
    assert found.dtype == np.uint8
    assert np.abs(found - expected).max() <= 0.5 + 1e-3


def test_an_even_grey_stays_what_it_is():
    grey = np.full((240, 320), 137, np.uint8)
    assert (Blur((320, 240), (128, 128), (240.0, 33.0))(grey) == 137).all()


def test_stripes_along_the_blur_stay_and_stripes_across_it_go():
    row = np.where(np.arange(320) % 16 < 8, 40, 200).astype(np.uint8)
    upright = np.tile(row, (240, 1))
    assert (Blur((320, 240), (320, 240), (0.0, 33.0))(upright) == upright).all()
    assert np.ptp(Blur((320, 240), (128, 128), (33.0, 0.0))(upright)) <= 1


def test_a_margin_that_the_blur_reaches_gives_the_same_pixels_as_the_whole_picture(picture):
    whole = Blur((320, 240), (128, 128), (4.0, 2.0))(picture)
    margin = picture[240 // 2 - 70 : 240 // 2 + 70, 160 - 76 : 160 + 76]
    assert (Blur((152, 140), (128, 128), (4.0, 2.0))(margin) == whole).all()
