"""Messages as the bytes that travel, made once; then only the stamp and the numbers are put in.

To make a message, convert and serialize it costs five times as much, at each message of the loop.
"""

import struct
from itertools import takewhile
from typing import Any

import numpy as np
from rclpy.serialization import serialize_message

from lockstep.stamps import NS_PER_S

_STAMP = struct.Struct("<iI")
_STAMP_OFFSET = 4  # behind the encapsulation (CDR, little-endian): a header comes first
_LENGTH_BYTES = 4  # of an array; an empty one has nothing else


class StampedBytes:
    """A serialized message of a type with a header, whose parts keep their sizes."""

    def __init__(self, message: Any, *places: np.ndarray) -> None:
        """places: arrays whose bytes are in the message once each, where values will go.

        In the message's order; behind the last one come empty arrays only.
        """
        data = serialize_message(message)
        starts = [data.index(place.tobytes()) for place in places]
        # A few bytes too many come behind empty arrays of numbers, whatever lay in memory there;
        # strict readers of a bag refuse these.
        end = starts[-1] + places[-1].nbytes + _LENGTH_BYTES * _n_empty_last(message)
        self._data = bytearray(data[:end])
        self._fields = [
            np.frombuffer(self._data, place.dtype, place.size, start)
            for place, start in zip(places, starts, strict=True)
        ]

    def fill(self, stamp_ns: int, *values: Any) -> bytes:
        """Return the message of a stamp with values in the places, each as large as its place."""
        _STAMP.pack_into(self._data, _STAMP_OFFSET, *divmod(stamp_ns, NS_PER_S))
        for field, value in zip(self._fields, values, strict=True):
            field[:] = value
        return bytes(self._data)


def _n_empty_last(message: Any) -> int:
    """Return how many of the message's last fields are empty arrays."""
    fields = [getattr(message, name) for name in message.get_fields_and_field_types()]
    return len(list(takewhile(lambda field: len(field) == 0, reversed(fields))))
