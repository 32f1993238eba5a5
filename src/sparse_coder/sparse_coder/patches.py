"""From two grey images to normalised binocular patches of a scale (K17 II, image processing).

Dimensions: n_patches of one scale, n_pixels of one binocular patch (left eye's 64, then the right
eye's 64, each row by row).
"""

from collections.abc import Sequence

import cv2
import numpy as np
from numba import float32, float64, njit, void
from numpy.typing import NDArray

from lockstep import InputError
from lockstep.scales import PATCH_SIZE_PX, STRIDE_PX, Scale, ScalesConfig

N_PIXELS = 2 * PATCH_SIZE_PX**2
# The published model's scales.
COARSE, FINE = ScalesConfig().all

_LEAST_SEEN_SHARE = 0.01

Image = NDArray[np.uint8]
Window = NDArray[np.float32]
Patches = NDArray[np.float32]


def check_images(left: Image, right: Image, least_px: int = COARSE.window_px) -> None:
    """Refuse anything but two uint8 images of one even size that holds a window of least_px.

    An odd side has no pixel border in its middle, so no window could be centred on it.
    """
    for name, image in (("left", left), ("right", right)):
        if not isinstance(image, np.ndarray) or image.dtype != np.uint8 or image.ndim != 2:
            raise InputError(
                f"{name} image: expected a grey uint8 array (height, width), "
                f"got {_described(image)}"
            )
        if min(image.shape) < least_px or any(side % 2 for side in image.shape):
            raise InputError(
                f"{name} image: expected even sides of at least {least_px} px, "
                f"got height {image.shape[0]}, width {image.shape[1]}"
            )
    if left.shape != right.shape:
        raise InputError(
            f"images: expected one size for both eyes, got left {left.shape}, right {right.shape}"
        )


def window_of(image: Image, scale: Scale) -> Window:
    """Return the central window of a picture at a scale, (size_px, size_px).

    Cropped first (D4), so that a picture of the central region alone gives the same window, and
    reduced by a Gaussian pyramid (Burt & Adelson 1983). In float32 each sum of the pyramid is exact
    for two reductions: 8 bits, and 8 more per reduction, fit in 24.
    """
    top, first = ((side - scale.window_px) // 2 for side in image.shape)
    central = image[top : top + scale.window_px, first : first + scale.window_px]
    window = central.astype(np.float32)
    for _ in range(scale.n_reductions):
        window = np.asarray(cv2.pyrDown(window), np.float32)
    return window


def binocular_patches(left: Window, right: Window) -> Patches:
    """Return all patches of two windows, (n_patches, n_pixels), in reading order.

    Each eye's part has mean 0 and norm 1, or is all 0 where the image is flat.
    """
    return patches_and_energies(left, right)[0]


def patches_and_energies(left: Window, right: Window) -> tuple[Patches, NDArray[np.float64]]:
    """Return the patches as `binocular_patches` does, and their energies, (n_patches, 2).

    An energy is the sum of squares of one eye's part, once its mean is 0, before it has norm 1.
    """
    n_rows, n_columns = ((side - PATCH_SIZE_PX) // STRIDE_PX + 1 for side in left.shape)
    patches = np.empty((n_rows * n_columns, N_PIXELS), np.float32)
    energies = np.empty((len(patches), 2))
    half = N_PIXELS // 2
    _normalised_patches(left, patches[:, :half], energies[:, 0])
    _normalised_patches(right, patches[:, half:], energies[:, 1])
    return patches, energies


def sees_with_both(energies: Sequence[NDArray[np.float64]]) -> bool:
    """Return whether each eye sees something: more than 1 % of the energy of the other one.

    energies: per scale (n_patches, 2), as `patches_and_energies` returns them. A covered eye may
    have its sensor's noise.
    """
    of_eyes = np.sum([of_scale.sum(axis=0) for of_scale in energies], axis=0)
    return bool(of_eyes.min() > _LEAST_SEEN_SHARE * of_eyes.max())


# "reassoc" lets the sums use the vector unit; the order is fixed once compiled, so that the same
# machine gives the same bits.
@njit(
    void(float32[:, ::1], float32[:, :], float64[:]),
    cache=True,
    nogil=True,
    fastmath={"reassoc"},
)
def _normalised_patches(window: Window, patches: Patches, energies: NDArray[np.float64]) -> None:
    n_columns = (window.shape[1] - PATCH_SIZE_PX) // STRIDE_PX + 1
    for i_patch in range(patches.shape[0]):
        top = STRIDE_PX * (i_patch // n_columns)
        first = STRIDE_PX * (i_patch % n_columns)
        total = 0.0
        for y in range(PATCH_SIZE_PX):
            for x in range(PATCH_SIZE_PX):
                total += np.float64(window[top + y, first + x])
        mean = total / PATCH_SIZE_PX**2
        energy = 0.0
        for y in range(PATCH_SIZE_PX):
            for x in range(PATCH_SIZE_PX):
                energy += (np.float64(window[top + y, first + x]) - mean) ** 2
        energies[i_patch] = energy
        scale = 1.0 / np.sqrt(energy) if energy > 0.0 else 0.0
        for y in range(PATCH_SIZE_PX):
            for x in range(PATCH_SIZE_PX):
                deviation = np.float64(window[top + y, first + x]) - mean
                patches[i_patch, PATCH_SIZE_PX * y + x] = np.float32(deviation * scale)


def _described(image: object) -> str:
    if isinstance(image, np.ndarray):
        return f"{image.dtype} of shape {image.shape}"
    return type(image).__name__
