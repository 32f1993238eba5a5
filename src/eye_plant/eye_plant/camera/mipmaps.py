"""Smaller copies of a picture: which there are, and which of them suits a distance.

Each picture has two chains of copies, each half the size of the one before: from the picture itself
and from a copy reduced by sqrt(2). Of all their levels, half an octave apart, one serves a whole
picture: a third cheaper to draw than a mixture of the two nearest levels of one chain, pixel by
pixel, and as sharp everywhere and in both eyes.
"""

import math

import cv2
import numpy as np


def wants_reduced(texels_per_pixel: float) -> bool:
    """Return whether the reduced chain has the level nearest to so many texels in a pixel.

    texels_per_pixel: of the picture itself, at its full size.
    """
    octave = math.log2(texels_per_pixel)
    return octave > 0.25 and 0.25 <= octave % 1.0 < 0.75


def reduced(picture: np.ndarray) -> np.ndarray:
    """Return picture (height, width) uint8 at 1 / sqrt(2) of its size, by area averaging."""
    height_px, width_px = (max(1, round(side / math.sqrt(2.0))) for side in picture.shape)
    smaller = cv2.resize(picture, (width_px, height_px), interpolation=cv2.INTER_AREA)
    return smaller.reshape(height_px, width_px)


def mipmap_levels(picture: np.ndarray) -> list[np.ndarray]:
    """Return picture (height, width) uint8 and its successive halves down to one pixel.

    Sizes are floor(size / 2), at least 1, as OpenGL wants them.
    """
    levels = [picture]
    while max(levels[-1].shape) > 1:
        height_px, width_px = levels[-1].shape
        size_px = (max(1, width_px // 2), max(1, height_px // 2))
        half = cv2.resize(levels[-1], size_px, interpolation=cv2.INTER_AREA)
        levels.append(half.reshape(size_px[1], size_px[0]))
    return levels
