"""Both eyes' pictures in one."""

import numpy as np


def anaglyph(left: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Return (height, width, 3) uint8: the left picture in red, the right one in cyan."""
    return np.stack([left, right, right], axis=-1)
