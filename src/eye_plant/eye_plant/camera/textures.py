"""Grey pictures in the graphics memory, one byte per pixel.

MuJoCo's models hold colour textures only, three or four times the size, and keep a copy. Its
renderer however draws with whichever OpenGL textures its slots name, so these are uploaded here and
named there; switching a stimulus is one assignment. Four pictures share the channels of a texture,
which software draws faster than one of a single channel.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from types import ModuleType

import numpy as np

from eye_plant.camera.mipmaps import mipmap_levels, reduced, wants_reduced

_N_CHANNELS = 4


@dataclass(frozen=True)
class GreyTexture:
    """One picture in a channel of two mip-mapped textures, the second smaller by sqrt(2).

    full, reduced: their OpenGL names, the same without mip-maps; size_px: the longer side of
    the first; channel: 0 to 3.
    """

    full: int
    reduced: int
    size_px: int
    channel: int

    def name_for(self, texels_per_pixel: float) -> int:
        """Return the texture with the level nearest to so many texels (of full) in a pixel."""
        return self.reduced if wants_reduced(texels_per_pixel) else self.full


def upload_pictures(
    gl: ModuleType, pictures: Sequence[np.ndarray], *, with_mipmaps: bool
) -> list[GreyTexture]:
    """Upload pictures (height, width) uint8 at both sizes; those of one size share textures."""
    uploaded: dict[int, GreyTexture] = {}
    numbers = sorted(range(len(pictures)), key=lambda i: pictures[i].shape)
    for shape, alike_numbers in itertools.groupby(numbers, key=lambda i: pictures[i].shape):
        alike = list(alike_numbers)
        for start in range(0, len(alike), _N_CHANNELS):
            group = alike[start : start + _N_CHANNELS]
            full = [pictures[i] for i in group]
            name = upload_channels(gl, full, with_mipmaps=with_mipmaps)
            smaller = name
            if with_mipmaps:
                smaller = upload_channels(gl, [reduced(p) for p in full])
            for channel, i in enumerate(group):
                uploaded[i] = GreyTexture(name, smaller, max(shape), channel)
    return [uploaded[i] for i in range(len(pictures))]


def show_channel(gl: ModuleType, name: int, channel: int) -> None:
    """Let a texture be drawn in the grey of one of its channels."""
    gl.glBindTexture(gl.GL_TEXTURE_2D, name)
    channels = (gl.GL_RED, gl.GL_GREEN, gl.GL_BLUE, gl.GL_ALPHA)
    gl.glTexParameteri(gl.GL_TEXTURE_2D, gl.GL_TEXTURE_SWIZZLE_R, channels[channel])


def upload_channels(
    gl: ModuleType, pictures: Sequence[np.ndarray], *, with_mipmaps: bool = True
) -> int:
    """Upload one to four pictures (height, width) uint8 of one size, mip-mapped or not.

    Return the OpenGL name of the texture; it shows the first of them, in red alone. Row 0 becomes
    the texture's top. Each level halves the one before by area averaging, here and not by the
    driver, so that it is the same on every machine. Sampled bilinearly from the nearest level,
    clamped at the edges.
    """
    minifying = gl.GL_LINEAR_MIPMAP_NEAREST if with_mipmaps else gl.GL_LINEAR
    name = int(gl.glGenTextures(1))
    gl.glBindTexture(gl.GL_TEXTURE_2D, name)
    for parameter, value in (
        (gl.GL_TEXTURE_MIN_FILTER, minifying),
        (gl.GL_TEXTURE_MAG_FILTER, gl.GL_LINEAR),
        (gl.GL_TEXTURE_WRAP_S, gl.GL_CLAMP_TO_EDGE),
        (gl.GL_TEXTURE_WRAP_T, gl.GL_CLAMP_TO_EDGE),
        (gl.GL_TEXTURE_SWIZZLE_A, gl.GL_ONE),
    ):
        gl.glTexParameteri(gl.GL_TEXTURE_2D, parameter, value)
    gl.glPixelStorei(gl.GL_UNPACK_ALIGNMENT, 1)
    chains = [mipmap_levels(p) if with_mipmaps else [p] for p in pictures]
    for i_level, levels in enumerate(zip(*chains, strict=True)):
        height_px, width_px = levels[0].shape
        texels = np.zeros((height_px, width_px, _N_CHANNELS), np.uint8)
        for channel, level in enumerate(levels):
            texels[:, :, channel] = level
        gl.glTexImage2D(
            gl.GL_TEXTURE_2D,
            i_level,
            gl.GL_RGBA8,
            width_px,
            height_px,
            0,
            gl.GL_RGBA,
            gl.GL_UNSIGNED_BYTE,
            texels,
        )
    return name
