"""The windows that are coded: what each scale shows of both eyes' pictures."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from lockstep import InputError
from lockstep.scales import ScalesConfig
from sparse_coder.patches import Image, Window, check_images, window_of
from sparse_coder.whitening import whitened

_DEFAULT = ScalesConfig()


def windows_of(
    left: Image,
    right: Image,
    apart: Sequence[NDArray[np.uint8]] = (),
    scales: ScalesConfig = _DEFAULT,
) -> tuple[tuple[Window, Window], ...]:
    """Return the left and the right window (size_px, size_px) of each scale, in grey levels.

    Those for lenses are whitened. left, right: pictures that check_images accepts; apart:
    of each scale with a picture of its own both eyes' (2, height, width). Raises InputError
    for another number or kind of the latter.
    """
    if len(apart) != len(scales.apart):
        names = ", ".join(scale.name for scale in scales.apart) or "none"
        raise InputError(f"pictures of scales apart: expected those of {names}, got {len(apart)}")
    own = iter(apart)
    windows = []
    for i, scale in enumerate(scales.all):
        pair = left, right
        if scale.is_apart:
            pair = _pair(next(own), scale.name)
            check_images(*pair, scale.window_px)
        first, second = (window_of(picture, scale) for picture in pair)
        is_sharp = i >= scales.n_for_eyes
        windows.append((whitened(first), whitened(second)) if is_sharp else (first, second))
    return tuple(windows)


def _pair(pictures: NDArray[np.uint8], name: str) -> tuple[Image, Image]:
    if len(pictures) != 2:
        raise InputError(f"{name} pictures: expected two, got shape {np.shape(pictures)}")
    return pictures[0], pictures[1]
