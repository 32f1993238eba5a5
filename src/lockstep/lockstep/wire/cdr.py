"""Messages as the bytes that travel: where the numbers are, how to read them and fill them in.

CDR (OMG XCDR version 1) puts a 4-byte header before the message and aligns each number to its own
size, counted from behind that header. The messages of a topic have the same names and lengths for a
whole run, so the first one tells where the numbers of all are. To make a message, convert and
serialize it costs five times as much as to put its numbers in here, and to deserialize one ten
times as much as to take them out: at each message of the loop.
"""

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from lockstep.errors import InputError
from lockstep.wire.stamps import NS_PER_S, checked_stamp

_HEADER_BYTES = 4
_ORDERS = {b"\x00\x01": "<", b"\x00\x00": ">"}
_LITTLE_ENDIAN_HEADER = b"\x00\x01\x00\x00"
_STAMP_BYTES = 8  # int32 sec, uint32 nanosec: the first part of a message's header

# Offset in the message, its header included, and number of values.
Block = tuple[int, int]


class _Cursor:
    """A position in a message, counted from behind the CDR header.

    told: the parts read so far, without the padding between them. Fast CDR leaves in its padding
    whatever its buffer held before, so equal messages need not be equal byte by byte.
    """

    def __init__(self, message: bytes) -> None:
        order = _ORDERS.get(bytes(message[:2]))
        if order is None or len(message) < _HEADER_BYTES + _STAMP_BYTES:
            raise InputError(f"expected a CDR message, got {bytes(message[:4]).hex() or 'nothing'}")
        self.order = order
        self._count = struct.Struct(order + "I")
        self.body = message[_HEADER_BYTES:]
        self.position = _STAMP_BYTES
        self.told: list[slice] = []

    def count(self) -> int:
        self._align(4)
        start = self.skip(4)
        (value,) = self._count.unpack_from(self.body, start)
        return int(value)

    def skip(self, n_bytes: int) -> int:
        start = self.position
        self.position += n_bytes
        if self.position > len(self.body):
            raise InputError(
                f"expected a message of at least {self.position} bytes, got {len(self.body)}"
            )
        self.told.append(slice(start + _HEADER_BYTES, self.position + _HEADER_BYTES))
        return start

    def string(self) -> str:
        length = self.count()
        start = self.skip(length)
        try:
            return self.body[start : start + length].rstrip(b"\0").decode()
        except UnicodeDecodeError as error:
            raise InputError(f"expected text in UTF-8: {error}") from error

    def block(self, item_bytes: int) -> Block:
        """Skip a sequence of numbers, of which only the length is told."""
        length = self.count()
        if length:
            self._align(item_bytes)
        start = self.skip(item_bytes * length)
        self.told.pop()
        return start + _HEADER_BYTES, length

    def _align(self, n_bytes: int) -> None:
        self.position = -(-self.position // n_bytes) * n_bytes


@dataclass(frozen=True)
class VectorLayout:
    """Where a sensor_msgs/JointState keeps its numbers.

    order: "<" or ">", as in struct; blocks: of position, velocity and effort; told: the bytes that
    hold its frame, its names and its lengths.
    """

    names: tuple[str, ...]
    order: str
    blocks: tuple[Block, Block, Block]
    told: tuple[slice, ...]

    @classmethod
    def of(cls, message: bytes) -> "VectorLayout":
        """Read the layout from a message; InputError when it is no JointState."""
        try:
            cursor = _Cursor(message)
            cursor.string()
            names = tuple(cursor.string() for _ in range(cursor.count()))
            blocks = (cursor.block(8), cursor.block(8), cursor.block(8))
        except InputError as error:
            raise _no_message("JointState", message, error) from error
        return cls(names, cursor.order, blocks, tuple(cursor.told))

    @cached_property
    def dtype(self) -> np.dtype[Any]:
        """The type of the numbers."""
        return np.dtype(f"{self.order}f8")

    def fits(self, messages: np.ndarray, first: np.ndarray) -> np.ndarray:
        """Return which messages (n, n_bytes) have the frame, names and lengths of the first."""
        mask = np.zeros(messages.shape[1], np.uint8)
        for part in (slice(0, _HEADER_BYTES), *self.told):
            mask[part] = 0xFF
        return ~((messages ^ first) & mask).any(axis=1)

    def values(self, messages: np.ndarray, i_field: int) -> np.ndarray:
        """Return field 0, 1 or 2 of messages (n, n_bytes) uint8: (n, length) float64."""
        start, length = self.blocks[i_field]
        numbers = np.ascontiguousarray(messages[:, start : start + 8 * length]).view(self.dtype)
        values: np.ndarray = numbers.astype(np.float64, copy=False)
        return values.reshape(len(messages), length)


@dataclass(frozen=True)
class ImageLayout:
    """What a sensor_msgs/Image says of its picture, and where it is; block: of its bytes."""

    height: int
    width: int
    encoding: str
    is_bigendian: int
    step: int
    block: Block

    @classmethod
    def of(cls, message: bytes) -> "ImageLayout":
        """Read the layout from a message; InputError when it is no Image."""
        try:
            cursor = _Cursor(message)
            cursor.string()
            height, width = cursor.count(), cursor.count()
            encoding = cursor.string()
            is_bigendian = cursor.body[cursor.skip(1)]
            return cls(height, width, encoding, is_bigendian, cursor.count(), cursor.block(1))
        except InputError as error:
            raise _no_message("Image", message, error) from error


def _no_message(kind: str, message: bytes, error: InputError) -> InputError:
    return InputError(f"expected a serialized {kind}, got {len(message)} bytes: {error}")


def image_array(message: bytes) -> np.ndarray:
    """Return the picture of a serialized sensor_msgs/Image.

    mono8: (height, width) uint8; 32FC1: (height, width) float32. Raises InputError for any other.
    """
    layout = ImageLayout.of(message)
    kinds: dict[str, np.dtype[Any]] = {"mono8": np.dtype("u1"), "32FC1": np.dtype("<f4")}
    if layout.encoding not in kinds or layout.is_bigendian:
        raise InputError(
            f"expected a little-endian mono8 or 32FC1 picture, got {layout.encoding!r}"
        )
    kind, row_bytes = kinds[layout.encoding], layout.width * kinds[layout.encoding].itemsize
    start, n_bytes = layout.block
    if n_bytes != layout.step * layout.height or layout.step < row_bytes:
        raise InputError(
            f"expected {layout.height} rows of {layout.width} {layout.encoding}, "
            f"got {n_bytes} bytes in steps of {layout.step}"
        )
    rows = np.frombuffer(message, np.uint8, n_bytes, start).reshape(layout.height, layout.step)
    return np.ascontiguousarray(rows[:, :row_bytes]).view(kind)


class Alike:
    """Tells messages that differ from a first one in nothing but stamp and numbers."""

    def __init__(self, first: bytes, blocks: Sequence[slice]) -> None:
        """blocks: the bytes of first that hold numbers, one behind the other."""
        self._n_bytes = len(first)
        starts = [_HEADER_BYTES + _STAMP_BYTES, *(block.stop for block in blocks)]
        ends = [*(block.start for block in blocks), len(first)]
        between = [slice(*part) for part in zip(starts, ends, strict=True)]
        self._fixed = [(part, first[part]) for part in (slice(0, _HEADER_BYTES), *between)]

    def fits(self, message: bytes) -> bool:
        """Whether a message has the same frame, names and lengths, and the same padding."""
        return len(message) == self._n_bytes and all(
            message[part] == held for part, held in self._fixed
        )


def stamp_of(message: bytes) -> tuple[int, int]:
    """Return seconds and nanoseconds of a message that begins with a header, as they are.

    Raises InputError for a message that is too short to have them.
    """
    if len(message) < _HEADER_BYTES + _STAMP_BYTES:
        raise InputError(f"expected a message with a header, got {len(message)} bytes")
    order = "<" if message[1] else ">"
    seconds, nanoseconds = struct.unpack_from(f"{order}iI", message, _HEADER_BYTES)
    return seconds, nanoseconds


def stamp_ns_of(message: bytes) -> int:
    """Return the stamp of a message that begins with a header; InputError for an impossible one."""
    return checked_stamp(*stamp_of(message))


class StampedBytes:
    """A serialized message of a type with a header, whose stamp and numbers change."""

    _STAMP = struct.Struct("<iI")

    def __init__(self, message: bytearray, blocks: Sequence[tuple[Any, Block]] = ()) -> None:
        """message: little-endian, taken over; blocks: type and block of what changes."""
        self._data = message
        self._fields = [np.frombuffer(message, kind, n, start) for kind, (start, n) in blocks]

    def fill(self, stamp_ns: int, *values: Any) -> bytes:
        """Return the message of a stamp with values in the blocks, each as large as its block."""
        self._STAMP.pack_into(self._data, _HEADER_BYTES, *divmod(stamp_ns, NS_PER_S))
        for field, value in zip(self._fields, values, strict=True):
            field[:] = value
        return bytes(self._data)


def clock_bytes(stamp_ns: int) -> bytes:
    """Return the serialized rosgraph_msgs/Clock of a stamp."""
    return struct.pack("<4siI", _LITTLE_ENDIAN_HEADER, *divmod(stamp_ns, NS_PER_S))
