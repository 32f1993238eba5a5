"""Grey pictures in the graphics memory, one byte per pixel.

MuJoCo's models hold colour textures only, three or four times the size, and keep a copy. Its
renderer however draws with whichever OpenGL textures its slots name, so these are uploaded here and
named there; switching a stimulus is one assignment.
"""

from types import ModuleType

import cv2
import numpy as np


def upload_grey_texture(gl: ModuleType, picture: np.ndarray) -> int:
    """Upload picture (height, width) uint8 with all its mip-map levels; return its OpenGL name.

    picture's row 0 becomes the texture's top. Each level halves the one before by area averaging,
    here and not by the driver, so that it is the same on every machine. Sampled trilinearly,
    clamped at the edges.
    """
    name = int(gl.glGenTextures(1))
    gl.glBindTexture(gl.GL_TEXTURE_2D, name)
    for parameter, value in (
        (gl.GL_TEXTURE_MIN_FILTER, gl.GL_LINEAR_MIPMAP_LINEAR),
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
