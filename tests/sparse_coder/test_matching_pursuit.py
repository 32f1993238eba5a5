import numpy as np
import pytest
from numpy.typing import NDArray

from sparse_coder.dictionary import Dictionary, initial_atoms
from sparse_coder.matching_pursuit import (
    Selections,
    matching_pursuit,
    mean_squared_coefficients,
    residual_energies,
)
from sparse_coder.patches import COARSE, FINE, binocular_patches, window_of
from sparse_coder.picture_of_code import coded_patches
from sparse_coder.reward import reconstruction_error
from tests.sparse_coder.slow import slow_pursuit


def random_patches(n_patches: int, n_pixels: int = 128) -> NDArray[np.float32]:
    patches = np.random.default_rng(3).standard_normal((n_patches, n_pixels))
    return (patches * np.sqrt(2.0) / np.linalg.norm(patches, axis=1, keepdims=True)).astype("f4")


def image_patches(picture: NDArray[np.uint8]) -> NDArray[np.float32]:
    windows = (window_of(picture, COARSE), window_of(picture, FINE))
    return np.concatenate([binocular_patches(w, np.roll(w, 1, axis=1).copy()) for w in windows])


def dictionary(n_bases: int = 400, n_pixels: int = 128) -> Dictionary:
    return Dictionary(initial_atoms(np.random.default_rng(1), n_bases, n_pixels))


def pursue(patches: NDArray[np.float32], of: Dictionary, n_selections: int = 10) -> Selections:
    return matching_pursuit(patches, of.atoms, of.gram, n_selections)


@pytest.mark.parametrize("of_images", [False, True])
def test_agrees_with_brute_force(picture: NDArray[np.uint8], of_images: bool) -> None:
    """Same atoms up to near-ties of 1e-5, where float32 may choose the other; same residual."""
    patches = image_patches(picture) if of_images else random_patches(60)
    of = dictionary()
    fast = pursue(patches, of)
    slow_atoms, slow_residuals = slow_pursuit(patches, of.atoms, 10)
    n_ties = 0
    for patch, fast_chosen, slow_chosen in zip(patches, fast.atoms, slow_atoms, strict=True):
        residual = patch.astype(np.float64)
        for k_fast, k_slow in zip(fast_chosen, slow_chosen, strict=True):
            correlations = of.atoms.astype(np.float64) @ residual
            if k_fast != k_slow:
                n_ties += 1
                assert abs(correlations[k_fast]) == pytest.approx(
                    abs(correlations[k_slow]), abs=1e-5
                )
                break
            residual -= correlations[k_slow] * of.atoms[k_slow]
    assert n_ties <= 0.02 * len(patches)
    energy = np.sum(patches.astype(np.float64) ** 2)
    expected = np.sum(slow_residuals**2) / energy
    # A near-tie changes which atoms follow, hence more than float32's rounding.
    tolerance = 1e-6 if n_ties == 0 else 1e-3
    assert reconstruction_error(patches, fast) == pytest.approx(expected, abs=tolerance)


def test_hand_computed_selections() -> None:
    atoms = np.array([[1.0, 0.0], [0.6, 0.8]], np.float32)
    got = pursue(np.array([[2.0, 1.0]], np.float32), Dictionary(atoms), 3)
    # (2, 1): 2 and 2; the first of equals. Residual (0, 1): 0 and 0.8. Then (-0.48, 0.36).
    np.testing.assert_array_equal(got.atoms, [[0, 1, 0]])
    np.testing.assert_allclose(got.coefficients, [[2.0, 0.8, -0.48]], atol=1e-6)


@pytest.mark.parametrize("n_bases", [1, 7, 33, 400])
def test_any_number_of_atoms(n_bases: int) -> None:
    of, patches = dictionary(n_bases), random_patches(5)
    expected, _ = slow_pursuit(patches, of.atoms, 4)
    np.testing.assert_array_equal(pursue(patches, of, 4).atoms, expected)


def test_error_never_grows_with_more_selections(picture: NDArray[np.uint8]) -> None:
    patches, of = image_patches(picture), dictionary()
    errors = [reconstruction_error(patches, pursue(patches, of, n)) for n in range(1, 21)]
    assert np.all(np.diff(errors) < 0)
    assert 0.0 < errors[-1] < errors[0] < 1.0


def test_energy_is_conserved_and_the_error_is_what_is_left_of_it(picture) -> None:
    patches, of = image_patches(picture), dictionary()
    selections = pursue(patches, of)
    explained = np.sum(selections.coefficients.astype(np.float64) ** 2, axis=1)
    left = np.sum((patches - coded_patches(selections, of.atoms)) ** 2, axis=1)
    np.testing.assert_allclose(explained + left, 2.0, atol=1e-5)
    np.testing.assert_allclose(residual_energies(patches, selections), left, atol=1e-5)
    error = reconstruction_error(patches, selections)
    assert error == pytest.approx(left.sum() / np.sum(patches**2), abs=1e-6)


def test_zero_patches_have_no_error_and_no_coefficients() -> None:
    patches, of = np.zeros((3, 128), np.float32), dictionary()
    selections = pursue(patches, of)
    np.testing.assert_array_equal(selections.coefficients, 0.0)
    assert reconstruction_error(patches, selections) == 0.0


def test_features_are_hand_computed_means_of_squares() -> None:
    atoms = np.array([[0, 2, 0], [2, 1, 1]], np.int32)
    coefficients = np.array([[1.0, 3.0, 0.5], [1.0, -2.0, 0.5]], np.float32)
    # Atom 0 comes twice in the first patch: 1.5^2; atom 1 twice in the second: (-1.5)^2.
    features = mean_squared_coefficients(Selections(atoms, coefficients), 4)
    np.testing.assert_array_equal(features, [2.25 / 2, 2.25 / 2, (9 + 1) / 2, 0])
    assert features.dtype == np.float32
