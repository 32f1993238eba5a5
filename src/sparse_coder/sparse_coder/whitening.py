"""Whitening of windows: all spatial frequencies count alike, up to those that noise takes over.

The transfer function |f| exp(-(f / 0.4)^4), f in cycles per pixel, flattens the 1/f spectrum of
natural pictures and cuts off what a sampled picture has above its resolution (Olshausen & Field
1997; their f_0 is 0.4, too).
"""

import cv2
import numpy as np
from numpy.typing import NDArray

_CUTOFF = 0.4
_HALF_PX = 7
# Of the grid on which the transfer function becomes a kernel: far beyond the kernel's reach.
_PERIOD_PX = 64


def whitened(window: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return a window (side_px, side_px), whitened; its mean is lost, its border mirrored."""
    filtered = cv2.filter2D(window, -1, KERNEL, borderType=cv2.BORDER_REFLECT)
    return np.asarray(filtered, np.float32)


def _kernel() -> NDArray[np.float32]:
    """Return the kernel (15, 15) of the transfer function, of sum 0."""
    f = np.fft.fftfreq(_PERIOD_PX)
    frequency = np.hypot(f[:, None], f)
    transfer = frequency * np.exp(-((frequency / _CUTOFF) ** 4))
    spread = np.fft.fftshift(np.fft.ifft2(transfer).real)
    middle = _PERIOD_PX // 2
    near = slice(middle - _HALF_PX, middle + _HALF_PX + 1)
    kernel = spread[near, near]
    return np.asarray(kernel - kernel.mean(), np.float32)


KERNEL = _kernel()
# Factor on the standard deviation of white noise.
GAIN = float(np.linalg.norm(KERNEL))
