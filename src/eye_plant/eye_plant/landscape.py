"""The landscape behind the plane: what eyes see that look past it."""

import cv2
import numpy as np

from lockstep.randomness import generator

WIDTH_PX = 2600  # 15 mm per pixel on a wall of 39 m: half a camera pixel at 9.1 m
HEIGHT_PX = 800


def landscape_picture(seed: int) -> np.ndarray:
    """Return a grey landscape, (800, 2600) uint8."""
    random = generator(seed, "landscape", 0)
    noise = random.integers(0, 256, (HEIGHT_PX // 4, WIDTH_PX // 4), dtype=np.uint8)
    return cv2.resize(noise, (WIDTH_PX, HEIGHT_PX), interpolation=cv2.INTER_CUBIC)
