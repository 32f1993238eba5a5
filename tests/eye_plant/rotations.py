"""Rotations of eyes, made by another library."""

import numpy as np
from scipy.spatial.transform import Rotation


def rotation(
    leftward_deg: float = 0.0, upward_deg: float = 0.0, clockwise_deg: float = 0.0
) -> np.ndarray:
    """Return forward, left and up of an eye that turns left, then up, then about its line of sight.

    clockwise as the eye itself sees it: its upper pole goes to the right.
    """
    angles_deg = leftward_deg, -upward_deg, clockwise_deg
    return np.asarray(Rotation.from_euler("ZYX", angles_deg, degrees=True).as_matrix())


def turned_inward(left_deg: float, right_deg: float) -> np.ndarray:
    """Return the rotations (2, 3, 3) of level eyes by their angles toward the nose."""
    return np.stack((rotation(-left_deg), rotation(right_deg)))
