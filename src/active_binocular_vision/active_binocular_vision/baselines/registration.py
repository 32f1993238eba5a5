"""The measure of turns, given the left and the right picture: the errors without any learning."""

import numpy as np
from numpy.typing import NDArray

from sparse_coder.gaze.movement import movement

Array = NDArray[np.float64]

# A right camera that has turned to the right, up and clockwise against the left one: the eyes
# converge too little, the right one is higher, and their upper poles lean away from each other.
_ERRORS_OF_MOVEMENT = np.array([1.0, -1.0, -1.0])


def registered_deg(left: NDArray[np.uint8], right: NDArray[np.uint8], focal_px: float) -> Array:
    """Return the errors (3,) that align two pictures (height_px, width_px), as GazeError's.

    NaN where they do not align. The right picture is taken for what the left eye saw after a turn.
    """
    return _ERRORS_OF_MOVEMENT * movement(left, right, focal_px)
