"""Grey pictures in the graphics memory, one byte per pixel.

MuJoCo's models hold colour textures only, three or four times the size, and keep a copy. Its
renderer however draws with whichever OpenGL textures its slots name, so these are uploaded here and
named there; switching a stimulus is one assignment.
"""

import math
from dataclasses import dataclass
from types import ModuleType

import cv2
import numpy as np


@dataclass(frozen=True)
class GreyTexture:
    """One picture in two mip-mapped textures, the second smaller by sqrt(2).

    full, reduced: their OpenGL names; size_px: the longer side of the first. Of their levels, half
    an octave apart, one serves a whole picture: a third cheaper to draw than a mixture of the two
    nearest levels of one texture, pixel by pixel, and as sharp everywhere and in both eyes.
    """

    full: int
    reduced: int
    size_px: int

    def name_for(self, texels_per_pixel: float) -> int:
        """Return the texture with the level nearest to so many texels (of full) in a pixel."""
        octave = math.log2(texels_per_pixel)
        return self.reduced if octave > 0.25 and 0.25 <= octave % 1.0 < 0.75 else self.full


def upload_picture(gl: ModuleType, picture: np.ndarray) -> GreyTexture:
    """Upload picture (height, width) uint8 at both sizes."""
    height_px, width_px = (max(1, round(side / math.sqrt(2.0))) for side in picture.shape)
    reduced = cv2.resize(picture, (width_px, height_px), interpolation=cv2.INTER_AREA)
    return GreyTexture(
        upload_grey_texture(gl, picture),
        upload_grey_texture(gl, reduced.reshape(height_px, width_px)),
        max(picture.shape),
    )


def upload_grey_texture(gl: ModuleType, picture: np.ndarray) -> int:
    """Upload picture (height, width) uint8 with all its mip-map levels; return its OpenGL name.

    picture's row 0 becomes the texture's top. Each level halves the one before by area averaging,
    here and not by the driver, so that it is the same on every machine. Sampled bilinearly from the
    nearest level, clamped at the edges.
    """
    name = int(gl.glGenTextures(1))
    gl.glBindTexture(gl.GL_TEXTURE_2D, name)
    for parameter, value in (
        (gl.GL_TEXTURE_MIN_FILTER, gl.GL_LINEAR_MIPMAP_NEAREST),
        (gl.GL_TEXTURE_MAG_FILTER, gl.GL_LINEAR),
        (gl.GL_TEXTURE_WRAP_S, gl.GL_CLAMP_TO_EDGE),
        (gl.GL_TEXTURE_WRAP_T, gl.GL_CLAMP_TO_EDGE),
    ):
        gl.glTexParameteri(gl.GL_TEXTURE_2D, parameter, value)
    gl.glPixelStorei(gl.GL_UNPACK_ALIGNMENT, 1)
    for i_level, level in enumerate(mipmap_levels(picture)):
        height_px, width_px = level.shape
        gl.glTexImage2D(
            gl.GL_TEXTURE_2D,
            i_level,
            gl.GL_LUMINANCE8,
            width_px,
            height_px,
            0,
            gl.GL_LUMINANCE,
            gl.GL_UNSIGNED_BYTE,
            np.ascontiguousarray(level),
        )
    return name


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
