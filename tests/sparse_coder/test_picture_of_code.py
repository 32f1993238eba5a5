import numpy as np
from numpy.typing import NDArray

from sparse_coder import Encoding
from sparse_coder.matching_pursuit import Selections
from sparse_coder.patches import binocular_patches
from sparse_coder.picture_of_code import coded_patches, reconstructed_windows, seen_windows


def perfect(left: NDArray[np.uint8], right: NDArray[np.uint8]) -> tuple[Encoding, np.ndarray]:
    """Return a code without error: each patch of both scales is an atom of its own."""
    windows = seen_windows(left, right)
    patches = tuple(binocular_patches(one, other) for one, other in windows)
    n_bases = max(len(p) for p in patches)
    atoms = np.zeros((2, n_bases, 128), np.float32)
    selections = []
    for its_atoms, its_patches in zip(atoms, patches, strict=True):
        n_patches = len(its_patches)
        its_atoms[:n_patches] = its_patches / np.sqrt(2.0)
        selections.append(
            Selections(
                np.arange(n_patches, dtype=np.int32)[:, np.newaxis],
                np.full((n_patches, 1), np.sqrt(2.0), np.float32),
            )
        )
    nothing = np.zeros(0)
    return Encoding(
        np.zeros((2, n_bases), np.float32),
        np.zeros(2),
        patches,
        tuple(selections),
        nothing,
        (),
        np.zeros(1),
    ), atoms


def test_a_code_without_error_gives_the_windows_back(picture: NDArray[np.uint8]) -> None:
    left, right = picture, np.roll(picture, 3, axis=1)
    encoding, atoms = perfect(left, right)
    for seen, reconstructed in zip(
        seen_windows(left, right), reconstructed_windows(encoding, atoms, left, right), strict=True
    ):
        np.testing.assert_allclose(reconstructed, seen, atol=0.01)


def test_a_patch_is_the_sum_of_its_atoms() -> None:
    atoms = np.eye(3, 128, dtype=np.float32)
    selections = Selections(
        np.array([[0, 2, 0]], np.int32), np.array([[0.5, -2.0, 0.25]], np.float32)
    )
    expected = np.zeros((1, 128))
    expected[0, 0], expected[0, 2] = 0.75, -2.0
    np.testing.assert_array_equal(coded_patches(selections, atoms), expected)
