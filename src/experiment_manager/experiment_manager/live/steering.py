"""Where people ask the eyes to look: in a viewer, or by a click in the page's picture."""

import json
from collections import deque

import numpy as np

from experiment_manager.live.shown import Shown
from lockstep import InputError
from lockstep.wire.topics import GAZE_TARGET, TARGET_NAMES
from lockstep.wire.vectors import values_of, vector_message
from sparse_coder.gaze.movement import swing_deg


class Steering:
    """Takes places from the servers' threads, and gives the newest to the node's."""

    def __init__(self, shown: Shown) -> None:
        """shown: the page, in whose left image people click."""
        self.shown = shown
        self._asked: deque[bytes] = deque(maxlen=1)

    def ask(self, message: bytes) -> None:
        """Keep a client's message of the topic gaze_target, until it is taken."""
        self._asked.append(message)

    def ask_at(self, column_px: float, row_px: float) -> None:
        """Ask for a place in the last left image, counted from its upper left corner, and mark it.

        Raises InputError for one outside.
        """
        if self.shown.size_px is None:
            raise InputError("expected an image of the left eye, none has come yet")
        width_px, height_px = self.shown.size_px
        if not (0.0 <= column_px <= width_px and 0.0 <= row_px <= height_px):
            raise InputError(
                f"expected a place in an image of {width_px} x {height_px} px, got column "
                f"{column_px:g} and row {row_px:g}"
            )
        focal_px = self.shown.focal_length_px
        place = column_px - width_px / 2.0, row_px - height_px / 2.0, focal_px
        position = swing_deg(np.array(place)).tolist()
        self.shown.mark(column_px, row_px)
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
