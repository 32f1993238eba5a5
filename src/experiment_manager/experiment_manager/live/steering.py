"""Where people ask the eyes to look: in a viewer, or by a click in the page's picture."""

import json
import math
import time
from collections import deque

import cv2
import numpy as np

from lockstep import InputError
from lockstep.wire.topics import GAZE_TARGET, TARGET_NAMES
from lockstep.wire.vectors import values_of, vector_message
from sparse_coder.gaze.movement import swing_deg

# So long after the page has asked for a picture, the next one is worth listening for.
_LOOKS_ON_S = 2.0


class Steering:
    """Takes places from the servers' threads, and gives the newest to the node's."""

    def __init__(self, focal_length_px: float) -> None:
        """focal_length_px: of the left picture, magnification included."""
        self._focal_length_px = focal_length_px
        self._asked: deque[bytes] = deque(maxlen=1)
        self._picture: np.ndarray | None = None
        self._looked_at_s = -math.inf

    def ask(self, message: bytes) -> None:
        """Keep a client's message of the topic gaze_target, until it is taken."""
        self._asked.append(message)

    def ask_at(self, column_px: float, row_px: float) -> None:
        """Ask for a place in the last picture, counted from its upper left corner.

        Raises InputError for one outside.
        """
        if self._picture is None:
            raise InputError("expected a picture of the left eye, none has come yet")
        height_px, width_px = self._picture.shape
        if not (0.0 <= column_px <= width_px and 0.0 <= row_px <= height_px):
            raise InputError(
                f"expected a place in a picture of {width_px} x {height_px} px, got column "
                f"{column_px:g} and row {row_px:g}"
            )
        place = column_px - width_px / 2.0, row_px - height_px / 2.0, self._focal_length_px
        position = swing_deg(np.array(place)).tolist()
        self.ask(json.dumps({"name": TARGET_NAMES, "position": position}).encode())

    def take(self) -> np.ndarray | None:
        """Return the values (2,) of TARGET_NAMES asked for last, None when nobody has asked since.

        Raises InputError for a message that is no vector with these names, written as JSON.
        """
        try:
            message = self._asked.pop()
        except IndexError:
            return None
        try:
            document = json.loads(message)
            vector = vector_message(0, document["name"], document["position"])
        except (ValueError, KeyError, TypeError, AssertionError) as error:
            raise InputError(
                f"{GAZE_TARGET}: expected JSON with name and position, got {message[:80]!r}"
            ) from error
        return values_of(vector, TARGET_NAMES, GAZE_TARGET)

    @property
    def wants_picture(self) -> bool:
        """Whether somebody has the page open."""
        return time.monotonic() - self._looked_at_s < _LOOKS_ON_S

    def show(self, picture: np.ndarray) -> None:
        """Keep the left eye's picture (height_px, width_px) uint8, for the page."""
        self._picture = picture.copy()

    def png(self) -> bytes:
        """Return the last picture as a PNG file, b"" before the first one."""
        self._looked_at_s = time.monotonic()
        if self._picture is None:
            return b""
        return cv2.imencode(".png", self._picture)[1].tobytes()
