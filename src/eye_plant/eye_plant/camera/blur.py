"""A Gaussian blur of any width, along either axis, of the part of a picture that is kept.

Along an axis the blur is a matrix, made once: two products give the picture. So a deviation of
240 px costs what one of 2 px costs, and what lies outside the kept part is read, never computed.
"""

import math

import numpy as np
from numpy.typing import NDArray

# The Gaussian is cut off at so many deviations: it has 0.3 % of its weight beyond.
_REACH = 3.0
# Sums in another order, as of another part of a picture, must not round another way: a half, which
# is no rare sum, lies clear of where rounding turns, and nothing else comes as near by chance.
_TIE = 1e-7


def blur_radius_px(deviation_px: float) -> int:
    """Return how far a blur reaches: what it mixes into a pixel lies so near."""
    return math.ceil(_REACH * deviation_px)


class Blur:
    """Blurs pictures of one size, and returns their central part."""

    def __init__(
        self,
        drawn_px: tuple[int, int],
        kept_px: tuple[int, int],
        deviations_px: tuple[float, float],
    ) -> None:
        """Lay out the blur; each pair is of width and height.

        deviations_px: standard deviations along the rows and along the columns, 0 leaves that axis
        as it is. Where the blur reaches beyond the picture, the picture goes on as its own mirror
        image, its outermost pixel not repeated.
        """
        along_rows, along_columns = (
            _operator(*sizes)
            for sizes in zip(drawn_px, kept_px, map(float, deviations_px), strict=True)
        )
        self._from_left = along_columns
        self._from_right = np.ascontiguousarray(along_rows.T)

    def __call__(self, picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Return the kept part (kept_height, kept_width) of picture (drawn_height, drawn_width)."""
        blurred = self._from_left @ picture.astype(np.float64) @ self._from_right
        return np.rint(blurred + _TIE).astype(np.uint8)


def _operator(n_drawn: int, n_kept: int, deviation_px: float) -> NDArray[np.float64]:
    """Return the matrix (n_kept, n_drawn) that blurs a line of pixels; its rows sum to 1."""
    radius = blur_radius_px(deviation_px)
    offsets = np.arange(-radius, radius + 1)
    weights = np.ones(1)
    if radius:
        weights = np.exp(-0.5 * (offsets / deviation_px) ** 2)
    kept = np.arange(n_kept) + (n_drawn - n_kept) // 2
    period = max(2 * (n_drawn - 1), 1)
    places = np.mod(kept[:, None] + offsets, period)
    places = np.where(places < n_drawn, places, period - places)
    operator = np.zeros((n_kept, n_drawn))
    np.add.at(operator, (np.arange(n_kept)[:, None], places), weights / weights.sum())
    return operator
