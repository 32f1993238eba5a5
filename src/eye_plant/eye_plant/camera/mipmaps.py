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


def reduced_shape(shape: tuple[int, ...]) -> tuple[int, int]:
    """Return height and width of the reduced copy of a picture of that height and width."""
    height_px, width_px = (max(1, round(side / math.sqrt(2.0))) for side in shape)
    return height_px, width_px


def reduced(picture: np.ndarray) -> np.ndarray:
    """Return picture (height, width) uint8 at 1 / sqrt(2) of its size, by area averaging."""
    return _resized(picture, reduced_shape(picture.shape))


def level_shapes(shape: tuple[int, ...]) -> list[tuple[int, int]]:
    """Return heights and widths of a picture's levels: each floor(size / 2), at least 1.

    As OpenGL wants them, from the picture's own down to one pixel.
    """
    height_px, width_px = shape
    shapes = [(height_px, width_px)]
    while max(shapes[-1]) > 1:
        height_px, width_px = shapes[-1]
        shapes.append((max(1, height_px // 2), max(1, width_px // 2)))
    return shapes


def mipmap_levels(picture: np.ndarray) -> list[np.ndarray]:
    """Return picture (height, width) uint8 and its successive halves, by area averaging."""
    levels = [picture]
    for shape in level_shapes(picture.shape)[1:]:
        levels.append(_resized(levels[-1], shape))
    return levels


def _resized(picture: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    return cv2.resize(picture, shape[::-1], interpolation=cv2.INTER_AREA).reshape(shape)
