import numpy as np
import pytest
from numpy.typing import NDArray

from lockstep import InputError
from sparse_coder.patches import (
    COARSE,
    FINE,
    binocular_patches,
    check_images,
    sees_with_both,
    window_of,
)
from tests.sparse_coder.slow import slow_patches, slow_reduction

IMAGE = np.zeros((240, 320), np.uint8)


def test_fine_window_is_the_central_40_px(picture: NDArray[np.uint8]) -> None:
    np.testing.assert_array_equal(window_of(picture, FINE), picture[110:150, 150:190])


def test_coarse_window_is_the_central_128_px_reduced_twice(picture: NDArray[np.uint8]) -> None:
    expected = slow_reduction(slow_reduction(picture[66:194, 106:234]))
    np.testing.assert_array_equal(window_of(picture, COARSE), expected)


def test_windows_of_the_central_region_alone_are_the_same(picture: NDArray[np.uint8]) -> None:
    centre = np.ascontiguousarray(picture[66:194, 106:234])
    np.testing.assert_array_equal(window_of(centre, COARSE), window_of(picture, COARSE))
    np.testing.assert_array_equal(window_of(centre, FINE), window_of(picture, FINE))


@pytest.mark.parametrize(("side", "n_patches"), [(32, 49), (40, 81), (8, 1)])
def test_number_of_patches(side: int, n_patches: int) -> None:
    window = np.zeros((side, side), np.float32)
    assert binocular_patches(window, window).shape == (n_patches, 128)


def test_patches_match_a_slow_extraction(picture: NDArray[np.uint8]) -> None:
    left, right = picture[:40, :40], picture[50:90, 60:100]
    patches = binocular_patches(left.astype(np.float32), right.astype(np.float32))
    np.testing.assert_allclose(patches, slow_patches(left, right), rtol=0, atol=1e-7)


def test_each_eye_has_mean_0_and_norm_1(picture: NDArray[np.uint8]) -> None:
    patches = binocular_patches(window_of(picture, COARSE), window_of(picture[::-1], COARSE))
    for half in (patches[:, :64], patches[:, 64:]):
        np.testing.assert_allclose(half.mean(axis=1), 0.0, atol=1e-7)
        np.testing.assert_allclose(np.linalg.norm(half, axis=1), 1.0, atol=1e-6)


def test_a_flat_half_is_zero_and_the_other_eye_keeps_its_norm(picture: NDArray[np.uint8]) -> None:
    flat = np.full((240, 320), 137, np.uint8)
    patches = binocular_patches(window_of(flat, COARSE), window_of(picture, COARSE))
    np.testing.assert_array_equal(patches[:, :64], 0.0)
    np.testing.assert_allclose(np.linalg.norm(patches[:, 64:], axis=1), 1.0, atol=1e-6)


def test_an_eye_with_a_hundredth_of_the_energy_of_the_other_one_sees_nothing() -> None:
    assert sees_with_both([np.array([[50.0, 1.0], [30.0, 0.0]]), np.array([[10.0, 0.0]])])
    assert not sees_with_both([np.array([[0.8, 60.0]]), np.array([[0.0, 20.0]])])
    assert not sees_with_both([np.zeros((2, 2))])


def test_a_single_grey_level_of_contrast_is_not_flat() -> None:
    window = np.full((8, 8), 255.0, np.float32)
    window[0, 0] = 254.0
    patch = binocular_patches(window, window)[0]
    assert patch[0] == pytest.approx(-63 / np.sqrt(63 * 64))
    assert patch[1] == pytest.approx(1 / np.sqrt(63 * 64))


@pytest.mark.parametrize(
    ("left", "right", "message"),
    [
        (IMAGE.astype(np.float32), IMAGE, "left image: expected a grey uint8 array .* got float32"),
        (IMAGE, np.zeros((240, 320, 3), np.uint8), r"right image: .*shape \(240, 320, 3\)"),
        (IMAGE, [[0]], "right image: .*got list"),
        (np.zeros((126, 320), np.uint8), IMAGE, "left image: .*at least 128 px, got height 126"),
        (np.zeros((241, 320), np.uint8), IMAGE, "left image: expected even sides"),
        (IMAGE, np.zeros((128, 128), np.uint8), "expected one size for both eyes"),
    ],
)
def test_bad_images_are_refused(left: object, right: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        check_images(left, right)  # type: ignore[arg-type]
