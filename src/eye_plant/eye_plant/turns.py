"""Turns of eyes, and of cameras in them: toward the nose, up, and about the line of sight.

World frame: x forward, y left, z up. The columns of a rotation are forward, left and up of what it
turns; the nose is right of the left eye and left of the right eye.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
# Of the left and the right eye: turn toward the nose, elevation, roll.
TurnsDeg = tuple[tuple[float, float, float], tuple[float, float, float]]

_FORWARD, _LEFT, _UP = range(3)
NO_TURNS_DEG: TurnsDeg = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
# A turn toward the nose goes this far to the left, of the left and the right eye.
_NASAL_TO_LEFT = (-1.0, 1.0)


def turned(rotations: Array, turns_deg: Sequence[Sequence[float]] | Array) -> Array:
    """Return rotations (2, 3, 3) of left and right eye, each turned further.

    turns_deg: (2, 3) of each eye the turn toward the nose, the elevation, and the roll of the upper
    side toward the nose, made in that order about the eye's own axes. Without any turn, the
    rotations themselves.
    """
    if not any(map(any, turns_deg)):
        return rotations
    result = np.array(rotations, dtype=np.float64)
    for axes, (inward, up, roll), to_left in zip(result, turns_deg, _NASAL_TO_LEFT, strict=True):
        _turn(axes, _FORWARD, _LEFT, to_left * inward)
        _turn(axes, _FORWARD, _UP, up)
        _turn(axes, _UP, _LEFT, to_left * roll)
    return result


def eye_rotations(eye_angles_rad: Array) -> Array:
    """Return the rotations (2, 3, 3) of eyes by their angles (2, 3), those of OculomotorState."""
    return turned(np.stack([np.eye(3)] * 2), np.degrees(eye_angles_rad))


def _turn(axes: Array, i_from: int, i_to: int, angle_deg: float) -> None:
    """Turn the columns of (3, 3) axes, one toward another."""
    sine, cosine = np.sin(np.radians(angle_deg)), np.cos(np.radians(angle_deg))
    moved, met = axes[:, i_from].copy(), axes[:, i_to].copy()
    axes[:, i_from] = cosine * moved + sine * met
    axes[:, i_to] = cosine * met - sine * moved
