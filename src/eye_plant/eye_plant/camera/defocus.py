"""What an eye out of focus makes of its picture: each point becomes a disc.

The disc's diameter is that of the pupil times the error of focus, as an angle: 4 mm x 1 D =
4 mrad, 0.23 deg (Smith 1982, in thin-lens approximation; diffraction and aberrations are left out).
"""

from functools import lru_cache

import numpy as np
from numba import int32, int64, njit, uint8, void
from numpy.typing import NDArray
from scipy.special import j1

# A blur mixes in what lies so near; of a wider disc the rest is cut off.
REACH_PX = 12
# Steps of the diameter, which keep the number of kernels small.
STEP_PX = 0.02
_N_GRID = 64
# Weights are whole numbers of this sum, so that sums are exact in any order and part of a picture.
_BITS = 16


def disc_diameter_px(pupil_m: float, error_d: float, focal_length_px: float) -> float:
    """Return the diameter of a point's disc: pupil x |error of focus| x focal length.

    error_d: of the dioptres in focus less those of the distance, of either sign.
    """
    return pupil_m * abs(error_d) * focal_length_px


def defocused(
    picture: NDArray[np.uint8], diameter_px: float, kept_px: tuple[int, int]
) -> NDArray[np.uint8]:
    """Return the central part (height, width) = kept_px of a picture whose points become discs.

    Where a disc reaches beyond the picture, the picture goes on as its own mirror image, its
    outermost pixel not repeated.
    """
    kernel = disc_kernel(round(diameter_px / STEP_PX))
    half = len(kernel) // 2
    margins = [(side - kept) // 2 for side, kept in zip(picture.shape, kept_px, strict=True)]
    lacking = [max(half - margin, 0) for margin in margins]
    if any(lacking):
        around = [(n, n) for n in lacking]
        picture = np.pad(picture, around, mode="reflect")
    top, left = (margin + lack - half for margin, lack in zip(margins, lacking, strict=True))
    blurred = np.empty(kept_px, np.uint8)
    _blur(np.ascontiguousarray(picture, np.int32), kernel, top, left, blurred)
    return blurred


@lru_cache(maxsize=2048)
def disc_kernel(n_steps: int) -> NDArray[np.int32]:
    """Return the weights (n, n), n odd, of a disc of n_steps times STEP_PX; their sum is 2^16.

    From the disc's transfer function, 2 J1(pi D f) / (pi D f), so that discs narrower than a pixel
    blur, too (Goodman 2005, section 6.4, for geometrical optics).
    """
    diameter_px = n_steps * STEP_PX
    half = min(int(diameter_px / 2.0 + 2.5), REACH_PX) if n_steps else 0
    frequency = np.fft.fftfreq(_N_GRID)
    x = np.maximum(np.pi * diameter_px * np.hypot(frequency[:, None], frequency), 1e-9)
    spread = np.fft.fftshift(np.fft.ifft2(2.0 * j1(x) / x).real)
    near = slice(_N_GRID // 2 - half, _N_GRID // 2 + half + 1)
    kernel = spread[near, near]
    weights = np.rint(kernel / kernel.sum() * 2**_BITS).astype(np.int32)
    weights[half, half] += 2**_BITS - weights.sum()
    return weights


@njit(
    void(int32[:, ::1], int32[:, ::1], int64, int64, uint8[:, ::1]),
    cache=True,
    nogil=True,
)
def _blur(
    picture: NDArray[np.int32],
    kernel: NDArray[np.int32],
    top: int,
    left: int,
    blurred: NDArray[np.uint8],
) -> None:
    """Fill blurred; the kernel's top left entry meets picture[top, left] for its first pixel."""
    height, width = blurred.shape
    total = np.empty(width, np.int32)
    for row in range(height):
        total[:] = int32(1 << (_BITS - 1))  # for rounding
        for i in range(kernel.shape[0]):
            line = picture[top + row + i]
            for j in range(kernel.shape[1]):
                weight, part = kernel[i, j], line[left + j : left + j + width]
                for column in range(width):
                    total[column] += weight * part[column]
        for column in range(width):
            blurred[row, column] = uint8(min(max(total[column] >> _BITS, 0), 255))
