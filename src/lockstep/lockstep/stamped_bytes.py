"""Messages as the bytes that travel, made once; then only the stamp and the numbers are put in.

To make a message, convert and serialize it costs five times as much, at each message of the loop.
"""

import struct
from typing import Any

import numpy as np
from rclpy.serialization import deserialize_message, serialize_message

from lockstep.stamps import NS_PER_S

_STAMP = struct.Struct("<iI")
_STAMP_OFFSET = 4  # behind the encapsulation (CDR, little-endian): a header comes first


class StampedBytes:
    """A serialized message of a type with a header, whose parts keep their sizes."""

    def __init__(self, message: Any, *places: np.ndarray) -> None:
        """places: arrays whose bytes are in the message once each, where values will go."""
        self._data = bytearray(exact_bytes(message))
        self._fields = [
            np.frombuffer(self._data, place.dtype, place.size, self._data.index(place.tobytes()))
            for place in places
        ]

    def fill(self, stamp_ns: int, *values: Any) -> bytes:
        """Return the message of a stamp with values in the places, each as large as its place."""
        _STAMP.pack_into(self._data, _STAMP_OFFSET, *divmod(stamp_ns, NS_PER_S))
        for field, value in zip(self._fields, values, strict=True):
            field[:] = value
        return bytes(self._data)


def exact_bytes(message: Any) -> bytes:
    """Return the serialized message as it travels.

    For a message that ends with empty arrays of numbers serialize_message returns a few bytes too
    many, from wherever they lay in memory; strict readers of a bag refuse these.
    """
    data: bytes = serialize_message(message)
    while _is_whole(data[:-1], type(message)):
        data = data[:-1]
    return data


def _is_whole(data: bytes, kind: type) -> bool:
    try:
        deserialize_message(data, kind)
    except Exception:  # of the middleware, private to rclpy
        return False
    return True
