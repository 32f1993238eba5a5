"""Messages as the bytes that travel, of which only the stamp and the numbers change.

To make a message, convert and serialize it costs five times as much as to put these in, and to
deserialize one ten times as much as to take them out: at each message of the loop.
"""

import struct
from typing import Any

import numpy as np
from rclpy.serialization import deserialize_message

from lockstep.errors import InputError
from lockstep.padding import serialized
from lockstep.stamps import NS_PER_S, checked_stamp

_STAMP = struct.Struct("<iI")
_STAMP_OFFSET = 4  # behind the encapsulation (CDR, little-endian): a header comes first
_LITTLE_ENDIAN = b"\x00\x01\x00\x00"
_CLOCK = struct.Struct("<4siI")


class StampedBytes:
    """A serialized message of a type with a header, whose parts keep their sizes."""

    def __init__(self, message: Any, *places: np.ndarray) -> None:
        """places: arrays, not empty, whose bytes are in the message, where values will go.

        In the message's order; behind the last one come empty arrays only. Without places only
        the stamp changes.
        """
        data = serialized(message)
        # From the end: a small array may look like something that stands before it.
        starts = [data.rindex(place.tobytes()) for place in places]
        ends = [start + place.nbytes for place, start in zip(places, starts, strict=True)]
        self._data = data
        self._places = [(p.dtype, p.size, start) for p, start in zip(places, starts, strict=True)]
        self._fields = [np.frombuffer(self._data, *place) for place in self._places]
        between = zip((_STAMP_OFFSET + _STAMP.size, *ends), (*starts, len(data)), strict=True)
        self._between = [slice(0, _STAMP_OFFSET), *(slice(*part) for part in between)]
        self._fixed: list[tuple[slice, bytes]] = []

    def fill(self, stamp_ns: int, *values: Any) -> bytes:
        """Return the message of a stamp with values in the places, each as large as its place."""
        _STAMP.pack_into(self._data, _STAMP_OFFSET, *divmod(stamp_ns, NS_PER_S))
        for field, value in zip(self._fields, values, strict=True):
            field[:] = value
        return bytes(self._data)

    def expect(self, data: bytes) -> bool:
        """Let `read` take messages like this one, which somebody serialized; say whether it can.

        Between the values they may differ from ours: what fills up a word is whatever lay there.
        """
        if len(data) != len(self._data) or data[:_STAMP_OFFSET] != self._data[:_STAMP_OFFSET]:
            return False
        self._fixed = [(part, data[part]) for part in self._between]
        return True

    def read(self, data: bytes) -> tuple[int, list[np.ndarray]] | None:
        """Return stamp (ns) and values of a message like the expected one; None of another.

        The arrays are views of data. Raises InputError for a stamp that cannot be.
        """
        if len(data) != len(self._data) or any(data[part] != held for part, held in self._fixed):
            return None
        stamp_ns = checked_stamp(*_STAMP.unpack_from(data, _STAMP_OFFSET))
        return stamp_ns, [np.frombuffer(data, *place) for place in self._places]


def deserialized(data: bytes, kind: type, topic: str) -> Any:
    """Return the message of that type; raises InputError when the bytes are none."""
    try:
        return deserialize_message(data, kind)
    except Exception as error:  # of the middleware, private to rclpy
        raise InputError(
            f"{topic}: expected a serialized {kind.__name__}, got {len(data)} bytes that are none"
        ) from error


def clock_bytes(stamp_ns: int) -> bytes:
    """Return the serialized rosgraph_msgs/Clock of a stamp."""
    return _CLOCK.pack(_LITTLE_ENDIAN, *divmod(stamp_ns, NS_PER_S))
