"""How both eyes turned, in episodes without saccades (D23)."""

import numpy as np
from numpy.typing import NDArray

from sparse_coder.encoding import Encoding
from sparse_coder.gaze.fixations import NOWHERE_DEG, UNSEEN_DEG, Gaze, Pictures, both_turns_deg

# The first command, and one when the eyes have verged and their muscles have relaxed.
_MEASURED = (1, 6)


class Turns:
    """Measures the turns of one episode after another, as Fixations does those of saccades."""

    def __init__(self, focal_length_px: float) -> None:
        """focal_length_px: of both cameras."""
        self._focal_length_px = focal_length_px
        self._pictures: Pictures | None = None

    def step(
        self,
        iteration: int,
        pictures: Pictures,
        encoding: Encoding,
        given_deg: NDArray[np.float64],
    ) -> Gaze:
        """Return what an observation says of gaze: turns, and never a target."""
        turns_deg = UNSEEN_DEG
        if iteration in _MEASURED and self._pictures is not None:
            turns_deg = both_turns_deg(self._pictures, pictures, self._focal_length_px)
        # Copies: a picture lasts until the next one.
        is_next = iteration + 1 in _MEASURED
        self._pictures = (pictures[0].copy(), pictures[1].copy()) if is_next else None
        return Gaze(NOWHERE_DEG, turns_deg)
