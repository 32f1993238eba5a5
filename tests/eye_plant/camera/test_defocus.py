"""Discs of defocus against a slow sum, and their size."""

import numpy as np
import pytest

from eye_plant.camera.defocus import REACH_PX, defocused, disc_diameter_px, disc_kernel

NOISE = np.random.default_rng(2).integers(0, 256, (60, 76), np.uint8)


def slow(picture: np.ndarray, kernel: np.ndarray, kept_px: tuple[int, int]) -> np.ndarray:
    """Return the central part, pixel by pixel, the picture mirrored beyond its border."""
    half = len(kernel) // 2
    around = np.pad(picture.astype(np.int64), half, mode="reflect")
    top, left = ((side - n) // 2 for side, n in zip(picture.shape, kept_px, strict=True))
    sums = [
        [
            (kernel * around[y : y + len(kernel), x : x + len(kernel)]).sum()
            for x in range(left, left + kept_px[1])
        ]
        for y in range(top, top + kept_px[0])
    ]
    return np.clip((np.array(sums) + 2**15) // 2**16, 0, 255)


@pytest.mark.parametrize("diameter_px", [0.0, 0.5, 4.1, 30.0])
@pytest.mark.parametrize("kept_px", [(60, 76), (40, 40)])
def test_discs_match_a_slow_sum(diameter_px: float, kept_px: tuple[int, int]) -> None:
    kernel = disc_kernel(round(diameter_px / 0.02))
    expected = slow(NOISE, kernel, kept_px)
    np.testing.assert_array_equal(defocused(NOISE, diameter_px, kept_px), expected)


def test_a_wider_picture_gives_the_same_pixels() -> None:
    """What is kept does not depend on what else is drawn, if that reaches as far as the disc."""
    whole = defocused(NOISE, 5.0, (20, 20))
    part = defocused(NOISE[10:-10, 8:-8], 5.0, (20, 20))
    np.testing.assert_array_equal(whole, part)


@pytest.mark.parametrize("diameter_px", [3.0, 6.0, 12.0])
def test_weights_lie_in_a_disc_of_the_diameter(diameter_px: float) -> None:
    """Second moment of a disc about its centre along one axis: (D / 4)^2."""
    kernel = disc_kernel(round(diameter_px / 0.02)) / 2**16
    assert kernel.sum() == 1.0
    x = np.arange(len(kernel)) - len(kernel) // 2
    inside = np.hypot(x[:, None], x) < diameter_px / 2.0 - 1.0
    area = np.pi * diameter_px**2 / 4.0
    np.testing.assert_allclose(kernel[inside].mean(), 1.0 / area, rtol=0.1)
    np.testing.assert_allclose(kernel[~inside].sum() + kernel[inside].sum(), 1.0)
    outside = np.hypot(x[:, None], x) > diameter_px / 2.0 + 1.5
    assert abs(kernel[outside]).sum() < 0.12


def test_focus_leaves_a_picture_as_it_is() -> None:
    np.testing.assert_array_equal(defocused(NOISE, 0.0, NOISE.shape), NOISE)


def test_a_dioptre_at_4_mm_is_4_mrad_of_either_sign() -> None:
    assert disc_diameter_px(0.004, 1.0, 1029.36) == pytest.approx(4.11744)
    assert disc_diameter_px(0.004, -0.5, 257.34) == pytest.approx(0.51468)


def test_the_widest_disc_is_cut_off() -> None:
    assert disc_kernel(10_000).shape == (2 * REACH_PX + 1, 2 * REACH_PX + 1)
