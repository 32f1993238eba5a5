"""Serialized messages without what the middleware leaves between their parts.

CDR (OMG XCDR version 1) aligns each number to its own size, counted from behind a 4-byte header.
Fast CDR does not write what it skips, so that it holds whatever lay in memory there; and some
bytes too many may come behind empty arrays of numbers, which strict readers of a bag refuse.
"""

import re
from typing import Any

from rclpy.serialization import serialize_message

_HEADER_BYTES = 4
_SIZES = {"boolean": 1, "octet": 1, "char": 1, "uint8": 1, "int8": 1, "uint16": 2, "int16": 2}
_SIZES |= {"uint32": 4, "int32": 4, "float": 4, "uint64": 8, "int64": 8, "double": 8}
_LENGTH_BYTES = 4
# As a message's class tells it: sequence<double>, sequence<double, 3>, double[9], std_msgs/Header.
_SEQUENCE = re.compile(r"^sequence<([^,>]+)")
_ARRAY = re.compile(r"^(.+)\[\d+\]$")


def serialized(message: Any) -> bytearray:
    """Return the serialized message, with zeros for padding and nothing behind the last part."""
    data = bytearray(serialize_message(message))
    walk = _Walk()
    walk.message(message)
    whole = bytearray(walk.end)
    for part in (slice(0, _HEADER_BYTES), *walk.parts):
        whole[part] = data[part]
    return whole


class _Walk:
    """Goes through the parts of a message as CDR puts them one behind the other."""

    def __init__(self) -> None:
        self.parts: list[slice] = []
        self.end = _HEADER_BYTES

    def message(self, message: Any) -> None:
        for name, kind in message.get_fields_and_field_types().items():
            self._part(getattr(message, name), kind)

    def _part(self, value: Any, kind: str) -> None:
        sequence, array = _SEQUENCE.match(kind), _ARRAY.match(kind)
        if sequence:
            self._skip(_LENGTH_BYTES)
            self._parts(value, sequence[1])
        elif array:
            self._parts(value, array[1])
        elif kind.startswith("string"):
            self._skip(_LENGTH_BYTES)
            self._skip(1, len(value.encode()) + 1)
        elif kind in _SIZES:
            self._skip(_SIZES[kind])
        else:
            self.message(value)

    def _parts(self, values: Any, kind: str) -> None:
        if kind in _SIZES:
            self._skip(_SIZES[kind], len(values))
            return
        for value in values:
            self._part(value, kind)

    def _skip(self, n_bytes: int, count: int = 1) -> None:
        if count:
            start = _HEADER_BYTES - (_HEADER_BYTES - self.end) // n_bytes * n_bytes
            self.end = start + n_bytes * count
            self.parts.append(slice(start, self.end))
