"""Reads many serialized messages of one topic at once, straight from the bytes of a bag's chunks.

CDR (OMG XCDR version 1, little endian) puts a 4-byte header before the message and aligns each
number to its own size, counted from behind that header. The messages of a topic have the same
names and lengths for a whole run, so the first one gives the place of each number in all.
"""

import struct
from dataclasses import dataclass
from typing import Any

import numpy as np

from lockstep.errors import InputError

_HEADER_BYTES = 4
_LITTLE_ENDIAN = b"\x00\x01"


class _Cursor:
    """A place in a message; positions count from behind the CDR header.

    told: the parts read so far, without the padding between them. Fast CDR leaves in its padding
    whatever its buffer held before, so equal messages need not be equal byte by byte.
    """

    def __init__(self, message: bytes) -> None:
        if message[:2] != _LITTLE_ENDIAN:
            raise InputError(f"expected a little-endian CDR message, got {message[:4].hex()}")
        self.body = message[_HEADER_BYTES:]
        self.position = 8  # behind the stamp of the header: int32 sec, uint32 nanosec
        self.told: list[slice] = []

    def count(self) -> int:
        self._align(4)
        (value,) = struct.unpack_from("<I", self.body, self.position)
        self.skip(4)
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
        return self.body[start : start + length].rstrip(b"\0").decode()

    def doubles(self) -> tuple[int, int]:
        """Skip a sequence of doubles; return its first byte and its length."""
        length = self.count()
        if length:
            self._align(8)
        start = self.skip(8 * length)
        self.told.pop()
        return start, length

    def _align(self, n_bytes: int) -> None:
        self.position = -(-self.position // n_bytes) * n_bytes


@dataclass(frozen=True)
class VectorLayout:
    """Where a sensor_msgs/JointState keeps its numbers.

    fields: (first byte, length) of position, velocity and effort in the whole message;
    told: the bytes that hold its frame, its names and its lengths.
    """

    names: tuple[str, ...]
    fields: tuple[tuple[int, int], tuple[int, int], tuple[int, int]]
    told: tuple[slice, ...]

    @classmethod
    def of(cls, message: bytes) -> "VectorLayout":
        """Read the layout from a message; InputError when it is no JointState."""
        try:
            cursor = _Cursor(message)
            cursor.string()
            names = tuple(cursor.string() for _ in range(cursor.count()))
            places = [cursor.doubles() for _ in range(3)]
        except (struct.error, UnicodeDecodeError) as error:
            raise InputError(f"expected a serialized JointState: {error}") from error
        wrong = [length for _, length in places if length not in (0, len(names))]
        if wrong:
            raise InputError(f"expected a number for each of {len(names)} names, got {wrong[0]}")
        position, velocity, effort = ((start + _HEADER_BYTES, n) for start, n in places)
        return cls(names, (position, velocity, effort), tuple(cursor.told))

    def fits(self, messages: np.ndarray, first: np.ndarray) -> np.ndarray:
        """Return which messages (n, n_bytes) have the frame, names and lengths of the first."""
        mask = np.zeros(messages.shape[1], np.uint8)
        for part in self.told:
            mask[part] = 0xFF
        return ~((messages ^ first) & mask).any(axis=1)

    def values(self, messages: np.ndarray, i_field: int) -> np.ndarray:
        """Return field 0, 1 or 2 of messages (n, n_bytes) uint8: (n, length) float64."""
        start, length = self.fields[i_field]
        block = np.ascontiguousarray(messages[:, start : start + 8 * length])
        values: np.ndarray = block.view("<f8").reshape(len(messages), length)
        return values


def image_array(message: bytes) -> np.ndarray:
    """Return the picture of a serialized sensor_msgs/Image.

    mono8: (height, width) uint8; 32FC1: (height, width) float32. Raises InputError for any other.
    """
    try:
        cursor = _Cursor(message)
        cursor.string()
        height, width = cursor.count(), cursor.count()
        encoding = cursor.string()
        big_endian = cursor.body[cursor.skip(1)]
        step = cursor.count()
        n_bytes = cursor.count()
        start = cursor.skip(n_bytes)
    except (struct.error, UnicodeDecodeError, IndexError) as error:
        raise InputError(f"expected a serialized Image: {error}") from error
    kinds: dict[str, np.dtype[Any]] = {"mono8": np.dtype("u1"), "32FC1": np.dtype("<f4")}
    if encoding not in kinds or big_endian:
        raise InputError(f"expected a little-endian mono8 or 32FC1 picture, got {encoding!r}")
    kind = kinds[encoding]
    if n_bytes != step * height or step < width * kind.itemsize:
        raise InputError(
            f"expected {height} rows of {width} {encoding}, got {n_bytes} bytes in steps of {step}"
        )
    rows = np.frombuffer(cursor.body, np.uint8, n_bytes, start).reshape(height, step)
    return np.ascontiguousarray(rows[:, : width * kind.itemsize]).view(kind)
