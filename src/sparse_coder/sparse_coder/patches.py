"""From two grey images to normalised binocular patches at two scales (K17 II, image processing).

Dimensions: n_patches of one scale, n_pixels of one binocular patch (left eye's 64, then the right
eye's 64, each row by row).
"""

import cv2
import numpy as np
from numba import float32, njit, void
from numpy.typing import NDArray

from lockstep import InputError

PATCH_SIZE_PX = 8
STRIDE_PX = 4
COARSE_WINDOW_PX = 128
FINE_WINDOW_PX = 40
N_REDUCTIONS = 2  # of the coarse window, a factor of 2 each
N_PIXELS = 2 * PATCH_SIZE_PX**2
# Pixels of the picture in one of the window, coarse before fine.
PX_PER_PIXEL = (float(2**N_REDUCTIONS), 1.0)

Image = NDArray[np.uint8]
Window = NDArray[np.float32]
Patches = NDArray[np.float32]


def check_images(left: Image, right: Image) -> None:
    """Refuse anything but two uint8 images of one even size that holds the coarse window.

    An odd side has no pixel border in its middle, so no window could be centred on it.
    """
    for name, image in (("left", left), ("right", right)):
        if not isinstance(image, np.ndarray) or image.dtype != np.uint8 or image.ndim != 2:
            raise InputError(
                f"{name} image: expected a grey uint8 array (height, width), "
                f"got {_described(image)}"
            )
        if min(image.shape) < COARSE_WINDOW_PX or any(side % 2 for side in image.shape):
            raise InputError(
                f"{name} image: expected even sides of at least {COARSE_WINDOW_PX} px, "
                f"got height {image.shape[0]}, width {image.shape[1]}"
            )
    if left.shape != right.shape:
        raise InputError(
            f"images: expected one size for both eyes, got left {left.shape}, right {right.shape}"
        )


def coarse_window(image: Image) -> Window:
    """Return the central 128 x 128 px, reduced twice by a Gaussian pyramid to 32 x 32.

    The pyramid is Burt & Adelson's (1983). Cropped first (D4), so that a picture of the central
    region alone gives the same window. In float32 each sum of the pyramid is exact: 8 bits, and 8
    more per reduction, fit in 24.
    """
    window = _centre(image, COARSE_WINDOW_PX)
    for _ in range(N_REDUCTIONS):
        window = np.asarray(cv2.pyrDown(window), np.float32)
    return window


def fine_window(image: Image) -> Window:
    """Return the central 40 x 40 px."""
    return _centre(image, FINE_WINDOW_PX)


def binocular_patches(left: Window, right: Window) -> Patches:
    """Return all patches of two windows, (n_patches, n_pixels), in reading order.

    Each eye's part has mean 0 and norm 1, or is all 0 where the image is flat.
    """
    n_rows, n_columns = ((side - PATCH_SIZE_PX) // STRIDE_PX + 1 for side in left.shape)
    patches = np.empty((n_rows * n_columns, N_PIXELS), np.float32)
    half = N_PIXELS // 2
    _normalised_patches(left, patches[:, :half])
    _normalised_patches(right, patches[:, half:])
    return patches


def _centre(image: Image, size_px: int) -> Window:
    top, first = ((side - size_px) // 2 for side in image.shape)
    return image[top : top + size_px, first : first + size_px].astype(np.float32)


# "reassoc" lets the sums use the vector unit; the order is fixed once compiled, so that the same
# machine gives the same bits.
@njit(void(float32[:, ::1], float32[:, :]), cache=True, nogil=True, fastmath={"reassoc"})
def _normalised_patches(window: Window, patches: Patches) -> None:
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
        scale = 1.0 / np.sqrt(energy) if energy > 0.0 else 0.0
        for y in range(PATCH_SIZE_PX):
            for x in range(PATCH_SIZE_PX):
                deviation = np.float64(window[top + y, first + x]) - mean
                patches[i_patch, PATCH_SIZE_PX * y + x] = np.float32(deviation * scale)


def _described(image: object) -> str:
    if isinstance(image, np.ndarray):
        return f"{image.dtype} of shape {image.shape}"
    return type(image).__name__
