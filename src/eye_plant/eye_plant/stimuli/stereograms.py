"""Stimuli that are not the same for both eyes: a texture per eye on the plane."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from eye_plant.stimuli.directory import choose_test_files
from eye_plant.stimuli.picture_file import read_each, read_picture, size_of_picture
from lockstep import SIDES, InputError, generator

# ours: at 6 m, where the plane of 3 m is 128 camera pixels wide, a dot is still 1.6 px.
_DOT_SHARE = 1.0 / 80.0
_DARK, _BRIGHT = 32, 224
# ours: of a plane of 3 m, +-0.4 of the eyes' baseline: dots that fuse at 0.7 to 1.7 times the
# plane's distance.
_LARGEST_PARALLAX = 0.0075


@dataclass(frozen=True)
class Stereogram:
    """A picture for each eye, (height, width) uint8, row 0 on top.

    parallax: how much farther right on the plane the left eye's picture shows what both show, as a
    share of the plane's width; with it the eyes must meet before the plane, without behind it.
    """

    left: np.ndarray
    right: np.ndarray
    parallax: float = 0.0


def random_dot_stereograms(seed: int, n: int, size_px: int) -> tuple[Stereogram, ...]:
    """Return n stereograms of (size_px, size_px) that show nothing but dots, black or white.

    Both eyes have the same dots, shifted against each other as a whole, so that the disparity is
    the only sign of depth (Julesz 1971). Shifts are drawn uniformly; a function of the seed.
    """
    return tuple(_random_dots(seed, number, size_px) for number in range(n))


def _random_dots(seed: int, number: int, size_px: int) -> Stereogram:
    draw = generator(seed, "random-dot stereogram", number)
    most_px = round(_LARGEST_PARALLAX * size_px)
    shift_px = int(draw.integers(-most_px, most_px + 1))
    dot_px = max(1, round(_DOT_SHARE * size_px))
    n_dots = -(-(size_px + most_px) // dot_px)
    dots = draw.integers(0, 2, (n_dots, n_dots), dtype=np.uint8)
    wide = np.kron(dots, np.ones((dot_px, dot_px), np.uint8)) * (_BRIGHT - _DARK) + _DARK
    # What lies at column c of the wide picture is at c less the first column that an eye sees.
    firsts_px = max(-shift_px, 0), max(shift_px, 0)
    left, right = (
        np.ascontiguousarray(wide[:size_px, first : first + size_px]) for first in firsts_px
    )
    return Stereogram(left, right, shift_px / size_px)


def read_stereograms(
    directory: str, seed: int, n_most: int, size_px: int, smallest_px: int
) -> tuple[Stereogram, ...]:
    """Return up to n_most stereograms of a directory: NAME_left and NAME_right of each, any suffix.

    Whether they show what is before or behind the plane is not known: the plane's own distance
    counts. Raises InputError naming a file that has no partner, or all that cannot be used.
    """
    pairs: dict[str, dict[str, Path]] = {}
    for path in choose_test_files(directory, seed):
        name, _, side = path.stem.rpartition("_")
        if side not in SIDES or not name:
            raise InputError(f"{path}: expected a name that ends in _left or _right")
        pairs.setdefault(name, {})[side] = path
    chosen = dict(list(pairs.items())[:n_most])
    for name, pair in chosen.items():
        if missing := set(SIDES) - set(pair):
            raise InputError(f"{directory}: expected {name}_{missing.pop()} beside the other eye's")
    read = partial(_read_pair, size_px=size_px, smallest_px=smallest_px)
    return tuple(read_each(read, [*chosen.values()]))


def _read_pair(pair: Mapping[str, Path], size_px: int, smallest_px: int) -> Stereogram:
    sizes_px = {side: size_of_picture(pair[side]) for side in SIDES}
    if sizes_px["left"] != sizes_px["right"]:
        raise InputError(
            f"{pair['right']}: expected an image of {_size(sizes_px['left'])} px, as the left "
            f"eye's, got {_size(sizes_px['right'])} px"
        )
    left, right = (read_picture(pair[side], size_px, smallest_px) for side in SIDES)
    return Stereogram(left, right)


def _size(shape: tuple[int, ...]) -> str:
    height_px, width_px = shape
    return f"{width_px} x {height_px}"
