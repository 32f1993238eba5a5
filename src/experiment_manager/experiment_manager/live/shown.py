"""What the page shows: both eyes' images, the running error, the last click, which run it is."""

import json
import math
import time
from collections.abc import Sequence

import cv2
import numpy as np

from experiment_manager.anaglyph import anaglyph
from lockstep import SIDES

# So long after the page has asked for an image, the next ones are worth listening for.
_LOOKS_ON_S = 2.0
# Of the curve; when there are as many, every second one is left out.
_MOST_POINTS = 600
ANAGLYPH = "anaglyph"


class Shown:
    """Written by the node's thread, read by the servers'.

    errors: (training iteration, running error in deg), evenly spread points of the curve.
    """

    def __init__(self, focal_length_px: float, run: str = "") -> None:
        """focal_length_px: of the left image, magnification included; run: its name."""
        self.focal_length_px = focal_length_px
        self._run = run
        self._images: dict[str, np.ndarray] = {}
        self.errors: list[tuple[float, float]] = []
        self._every, self._n_heard = 1, 0
        self._click_px: tuple[float, float] | None = None
        self._looked_at_s = -math.inf

    @property
    def is_watched(self) -> bool:
        """Whether somebody has the page open."""
        return time.monotonic() - self._looked_at_s < _LOOKS_ON_S

    @property
    def size_px(self) -> tuple[int, int] | None:
        """Width and height of the left eye's image; None before the first one."""
        left = self._images.get(SIDES[0])
        return None if left is None else (left.shape[1], left.shape[0])

    def show(self, images: Sequence[np.ndarray]) -> None:
        """Keep images (height_px, width_px) uint8, the left eye's first; with both an anaglyph."""
        self._images |= {side: image.copy() for side, image in zip(SIDES, images, strict=False)}
        if len(images) == len(SIDES):
            left, right = images
            self._images[ANAGLYPH] = anaglyph(left, right)[..., ::-1]  # OpenCV writes BGR

    def learn(self, training_iteration: float, running_error_deg: float) -> None:
        """Add a point to the curve of the running error."""
        if self._n_heard % self._every == 0:
            self.errors.append((training_iteration, running_error_deg))
        self._n_heard += 1
        if len(self.errors) >= _MOST_POINTS:
            self.errors, self._every = self.errors[::2], 2 * self._every

    def mark(self, column_px: float, row_px: float) -> None:
        """Remember where in the left image somebody has clicked."""
        self._click_px = column_px, row_px

    def png(self, name: str) -> bytes:
        """Return an image, left, right or anaglyph, as a PNG file; b"" before the first one."""
        self._looked_at_s = time.monotonic()
        image = self._images.get(name)
        return b"" if image is None else cv2.imencode(".png", image)[1].tobytes()

    def state(self) -> bytes:
        """Return the rest as JSON."""
        return json.dumps(
            {
                "run": self._run,
                "px_deg": math.degrees(math.atan(1.0 / self.focal_length_px)),
                "errors": self.errors,
                "click_px": self._click_px,
            }
        ).encode()
