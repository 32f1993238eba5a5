"""Grey pictures in the graphics memory, one byte per pixel.

MuJoCo's models hold colour textures only, three or four times the size, and keep a copy. Its
renderer however draws with whichever OpenGL textures its slots name, so these are uploaded here and
named there; switching a stimulus is one assignment.
"""

from types import ModuleType

import numpy as np

from eye_plant.camera.mipmaps import mipmap_levels, reduced


def upload_both_sizes(
    gl: ModuleType, picture: np.ndarray, *, with_mipmaps: bool
) -> tuple[int, int]:
    """Upload a picture (height, width) uint8, and reduced by sqrt(2); without mip-maps once.

    Return the OpenGL names of both textures.
    """
    name = upload_picture(gl, picture, with_mipmaps=with_mipmaps)
    return name, upload_picture(gl, reduced(picture)) if with_mipmaps else name


def upload_picture(gl: ModuleType, picture: np.ndarray, *, with_mipmaps: bool = True) -> int:
    """Upload a picture (height, width) uint8, mip-mapped or not.

    Return the OpenGL name of the texture, which has red alone. Row 0 becomes the texture's top.
    Each level halves the one before by area averaging, here and not by the driver, so that it is
    the same on every machine. Sampled bilinearly from the nearest level, clamped at the edges.
    """
    minifying = gl.GL_LINEAR_MIPMAP_NEAREST if with_mipmaps else gl.GL_LINEAR
    name = int(gl.glGenTextures(1))
    gl.glBindTexture(gl.GL_TEXTURE_2D, name)
    for parameter, value in (
        (gl.GL_TEXTURE_MIN_FILTER, minifying),
        (gl.GL_TEXTURE_MAG_FILTER, gl.GL_LINEAR),
        (gl.GL_TEXTURE_WRAP_S, gl.GL_CLAMP_TO_EDGE),
        (gl.GL_TEXTURE_WRAP_T, gl.GL_CLAMP_TO_EDGE),
    ):
        gl.glTexParameteri(gl.GL_TEXTURE_2D, parameter, value)
    gl.glPixelStorei(gl.GL_UNPACK_ALIGNMENT, 1)
    for i_level, level in enumerate(mipmap_levels(picture) if with_mipmaps else [picture]):
        height_px, width_px = level.shape
        gl.glTexImage2D(
            gl.GL_TEXTURE_2D,
            i_level,
            gl.GL_R8,
            width_px,
            height_px,
            0,
            gl.GL_RED,
            gl.GL_UNSIGNED_BYTE,
            np.ascontiguousarray(level),
        )
    return name
