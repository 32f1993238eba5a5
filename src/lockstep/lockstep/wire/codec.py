"""Messages of a topic, from and to bytes: only their numbers are written and read.

The messages of a topic have the same names and lengths for a whole run. To make a message, convert
and serialize it takes ten times as long as to write its numbers into the bytes of the first one,
and to deserialize it takes five times as long as to read them there.
"""

import struct
from types import SimpleNamespace
from typing import Any

import numpy as np

from lockstep.wire.cdr import HEADER_BYTES, STAMP, Layout, deserialized, layout_in, serialized
from lockstep.wire.stamps import NS_PER_S

_STAMP = struct.Struct("<iI")


class Writer:
    """Serializes messages like a first one, except in the stamp and in sequences of numbers."""

    def __init__(self, message: Any) -> None:
        """message: the sequences that change have their length, and the others are empty."""
        self._data = bytearray(serialized(message))
        self._fields = [
            np.frombuffer(self._data, block.dtype, block.length, block.start)
            for block in Layout(message).blocks.values()
            if block.length
        ]

    def __call__(self, stamp_ns: int, *values: Any) -> bytes:
        """Return the message of a stamp in ns and, if any, of values.

        values: each sequence of numbers that was not empty in the first message, in its order.
        """
        _STAMP.pack_into(self._data, STAMP.start, *divmod(stamp_ns, NS_PER_S))
        for field, value in zip(self._fields if values else (), values, strict=True):
            field[:] = value
        return bytes(self._data)


class Reader:
    """Deserializes a message only when it differs from those before in more than numbers.

    A new layout is learned when it comes twice running: to learn it costs many times as much as to
    deserialize, and a single foreign message would displace the layout of all others.
    """

    def __init__(self, kind: type, topic: str) -> None:
        """kind: of the messages; topic: for error messages."""
        self._kind, self._topic = kind, topic
        self._n_bytes = self._n_bytes_of_new = -1
        self._fixed: list[tuple[slice, bytes]] = []
        self._constants: dict[str, Any] = {}
        self._blocks: list[tuple[str, np.dtype[Any], int, int]] = []

    def __call__(self, data: bytes) -> Any:
        """Return the fields of a message without its header: numbers as read-only arrays.

        Raises InputError, which names the topic, for bytes that are no such message.
        """
        if len(data) != self._n_bytes or any(data[part] != held for part, held in self._fixed):
            message = deserialized(data, self._kind, self._topic)
            is_next = len(data) == self._n_bytes_of_new
            self._n_bytes_of_new = len(data)
            if self._n_bytes >= 0 and not is_next:
                return message
            layout = layout_in(data, message)
            if layout is None:
                return message
            self._learn(data, message, layout)
        self._n_bytes_of_new = -1
        fields = {
            name: np.frombuffer(data, dtype, length, start) if length else np.zeros(0, dtype)
            for name, dtype, length, start in self._blocks
        }
        return SimpleNamespace(**self._constants, **fields)

    def _learn(self, data: bytes, message: Any, layout: Layout) -> None:
        blocks = layout.blocks
        self._constants = {
            name: getattr(message, name)
            for name in message.get_fields_and_field_types()
            if name != "header" and name not in blocks
        }
        self._blocks = [
            (name, np.dtype(block.dtype), block.length, block.start)
            for name, block in blocks.items()
        ]
        starts = [STAMP.stop, *(block.bytes.stop for block in blocks.values())]
        ends = [*(block.start for block in blocks.values()), len(data)]
        between = [slice(*part) for part in zip(starts, ends, strict=True)]
        self._fixed = [(part, data[part]) for part in (slice(0, HEADER_BYTES), *between)]
        self._n_bytes = len(data)
