"""Messages of a topic, from and to bytes: by rclpy each time, or faster, with the same bytes.

The messages of a topic have the same names and lengths for a whole run. The plain way is here and
is what the fast one in `lockstep.wire.fast_codec` must equal; see `lockstep.plain` for the switch.
"""

import array
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from lockstep.plain import is_plain
from lockstep.wire.cdr import Layout, deserialized, serialized
from lockstep.wire.fast_codec import FastReader, FastWriter
from lockstep.wire.stamps import to_time

# Of a stamp in nanoseconds, and each sequence of numbers that was not empty in the first message.
Writer = Callable[..., bytes]
# Raises InputError for bytes that are no such message.
Reader = Callable[[bytes], Any]


def writer_of(message: Any) -> Writer:
    """Return what serializes messages like this one, except in stamp and number sequences."""
    return plain_writer(message) if is_plain() else FastWriter(message)


def reader_of(kind: type, topic: str) -> Reader:
    """Return what reads the fields of the messages of one topic; topic: for error messages."""
    return plain_reader(kind, topic) if is_plain() else FastReader(kind, topic)


def plain_writer(message: Any) -> Writer:
    """Return a writer that fills in the message, which is taken over, and serializes it."""
    codes = {
        name: np.dtype(block.dtype).char
        for name, block in Layout(message).blocks.items()
        if block.length
    }

    def write(stamp_ns: int, *values: Any) -> bytes:
        message.header.stamp = to_time(stamp_ns)
        for (name, code), value in zip(codes.items() if values else (), values, strict=True):
            setattr(message, name, array.array(code, np.asarray(value, code).tobytes()))
        return serialized(message)

    return write


def plain_reader(kind: type, topic: str) -> Reader:
    """Return a reader that deserializes each message."""
    return partial(deserialized, kind=kind, topic=topic)
