"""Pictures with their mip-map levels in plain memory, as the ray caster reads them.

A picture that is mapped from a file, as generated stimuli are, has its smaller copies in a file
beside it, made once and mapped too: they cost memory only where they are read, start-up costs no
time, and several runs share them.
"""

from collections.abc import Sequence
from itertools import accumulate
from pathlib import Path

import numpy as np

from eye_plant.camera.mipmaps import level_shapes, mipmap_levels, reduced, reduced_shape
from eye_plant.stimuli.cache import FileArray, map_array, write_array
from lockstep.machine.threads import map_in_threads

# One picture and its successive halves, read only: texels of level 0; those of all other levels,
# one after the other, row by row; (n_levels, 3) each level's offset in its array, height and width.
Texture = tuple[np.ndarray, np.ndarray, np.ndarray]

# Of the files beside pictures. Another one for other levels or another order of them: a test knows
# what version 1 holds.
_VERSION = 1


def textures_of(pictures: Sequence[np.ndarray]) -> list[tuple[Texture, Texture]]:
    """Return each picture (height, width) uint8 as a texture, and reduced by sqrt(2) as another."""
    # OpenCV and file systems let other threads run meanwhile.
    return map_in_threads(_both_textures, pictures)


def texture_of(picture: np.ndarray) -> Texture:
    """Return picture (height, width) uint8 as a texture."""
    levels = mipmap_levels(picture)
    smaller = np.concatenate([level.ravel() for level in levels[1:] or [np.empty(0, np.uint8)]])
    return _texture(picture.ravel(), smaller, 0, [level.shape for level in levels])


def _both_textures(picture: np.ndarray) -> tuple[Texture, Texture]:
    shapes, reduced_shapes = level_shapes(picture.shape), level_shapes(reduced_shape(picture.shape))
    n_smaller = sum(height_px * width_px for height_px, width_px in shapes[1:])
    n_texels = n_smaller + sum(height_px * width_px for height_px, width_px in reduced_shapes)
    copies = _smaller_copies(picture, n_texels)
    return (
        _texture(picture.ravel(), copies, 0, shapes),
        _texture(copies, copies, n_smaller, reduced_shapes),
    )


def _smaller_copies(picture: np.ndarray, n_texels: int) -> np.ndarray:
    """Return all levels but the largest, and all of the reduced picture, from a file if it can."""
    path = _file_beside(picture)
    copies = None if path is None else map_array(path, (n_texels,))
    if copies is not None:
        return copies
    levels = [*mipmap_levels(picture)[1:], *mipmap_levels(reduced(picture))]
    made = np.concatenate([level.ravel() for level in levels])
    try:
        return made if path is None else write_array(path, made)
    except OSError:  # a cache that cannot be written to, or is full
        return made


def _file_beside(picture: np.ndarray) -> Path | None:
    """Return the file for a mapped picture's smaller copies."""
    if not isinstance(picture, FileArray) or picture.path is None:
        return None
    return picture.path.with_suffix(f".v{_VERSION}.levels")


def _texture(
    largest: np.ndarray, texels: np.ndarray, first: int, shapes: Sequence[tuple[int, ...]]
) -> Texture:
    """Return the texture of these levels, which begin at first of their array."""
    sizes = [height_px * width_px for height_px, width_px in shapes]
    if largest is not texels:
        sizes[0] = 0
    offsets = list(accumulate(sizes[:-1], initial=first))
    levels = np.column_stack((offsets, shapes)).astype(np.int64)
    return _read_only(largest), _read_only(texels), _read_only(levels)


def _read_only(array: np.ndarray) -> np.ndarray:
    view = np.asarray(array).view()
    view.setflags(write=False)
    return view
