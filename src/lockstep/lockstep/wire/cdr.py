"""Messages as the bytes that travel: made and read by rclpy, and where their numbers are.

CDR (OMG XCDR version 1) puts a 4-byte header before the message and aligns each number to its own
size, counted from behind that header. Fast CDR does not write what it skips, so that it holds
whatever lay in memory there; and some bytes too many may come behind empty arrays of numbers, which
strict readers of a bag refuse. What is serialized here has neither.
"""

import re
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import Image, JointState

from lockstep.errors import InputError
from lockstep.wire.stamps import checked_stamp

HEADER_BYTES = 4
STAMP = slice(HEADER_BYTES, HEADER_BYTES + 8)  # int32 sec, uint32 nanosec: a header comes first
_ORDERS = {b"\x00\x01": "<", b"\x00\x00": ">"}
_DTYPES = {"boolean": "?", "octet": "u1", "char": "u1", "float": "f4", "double": "f8"}
_DTYPES |= {f"{u}int{8 * n}": f"{u or 'i'}{n}" for u in ("u", "") for n in (1, 2, 4, 8)}
# As a message's class writes it: sequence<double>, sequence<double, 3>, double[9], std_msgs/Header.
_SEQUENCE = re.compile(r"^sequence<([^,>]+)")
_ARRAY = re.compile(r"^(.+)\[\d+\]$")


def serialized(message: Any) -> bytes:
    """Return the serialized message, with zeros for padding and nothing behind the last part."""
    data = serialize_message(message)
    layout = Layout(message)
    whole = bytearray(layout.n_bytes)
    for part in layout.parts:
        whole[part] = data[part]
    return bytes(whole)


def deserialized(data: bytes, kind: type, topic: str = "") -> Any:
    """Return the message of that kind; InputError, which names the topic, when it is none."""
    where = f"{topic}: " if topic else ""
    refusal = InputError(f"{where}expected a serialized {kind.__name__}, got {len(data)} bytes")
    if data[:2] not in _ORDERS:
        raise refusal
    try:
        return deserialize_message(data, kind)
    except (_rclpy.RMWError, UnicodeDecodeError) as error:
        raise refusal from error


class Block(NamedTuple):
    """Where a message keeps a sequence of numbers; dtype: such as "f8"."""

    start: int
    length: int
    dtype: str

    @property
    def bytes(self) -> slice:
        """The bytes that hold the numbers."""
        return slice(self.start, self.start + self.length * np.dtype(self.dtype).itemsize)


class Layout:
    """The parts of a message as CDR puts them one behind the other, without what lies between."""

    def __init__(self, message: Any) -> None:
        """Go through a message with all its parts."""
        self.parts = [slice(0, HEADER_BYTES)]
        self.n_bytes = HEADER_BYTES
        self.blocks: dict[str, Block] = {}
        for name, kind in message.get_fields_and_field_types().items():
            value = getattr(message, name)
            self._part(value, kind)
            sequence = _SEQUENCE.match(kind)
            if sequence and sequence[1] in _DTYPES:
                start = self.parts[-1].start if len(value) else self.n_bytes
                self.blocks[name] = Block(start, len(value), _DTYPES[sequence[1]])

    def _part(self, value: Any, kind: str) -> None:
        sequence, array = _SEQUENCE.match(kind), _ARRAY.match(kind)
        if sequence:
            self._skip("u4")
            self._parts(value, sequence[1])
        elif array:
            self._parts(value, array[1])
        elif kind.startswith("string"):
            self._skip("u4")
            self._skip("u1", len(value.encode()) + 1)
        elif kind in _DTYPES:
            self._skip(_DTYPES[kind])
        else:
            for name, inner in value.get_fields_and_field_types().items():
                self._part(getattr(value, name), inner)

    def _parts(self, values: Sequence[Any], kind: str) -> None:
        if kind in _DTYPES:
            self._skip(_DTYPES[kind], len(values))
            return
        for value in values:
            self._part(value, kind)

    def _skip(self, dtype: str, count: int = 1) -> None:
        if count:
            n_bytes = np.dtype(dtype).itemsize
            start = HEADER_BYTES - (HEADER_BYTES - self.n_bytes) // n_bytes * n_bytes
            self.n_bytes = start + n_bytes * count
            self.parts.append(slice(start, self.n_bytes))


def layout_in(data: bytes, message: Any) -> Layout | None:
    """Return the layout of the bytes that a message was read from.

    None where it is another than that of the message: in the other byte order, and for text that is
    no UTF-8 or has a zero in it.
    """
    layout, again = Layout(message), serialized(message)
    return layout if all(again[part] == data[part] for part in layout.parts) else None


@dataclass(frozen=True)
class VectorLayout:
    """Where equally long sensor_msgs/JointState of the same names keep their numbers.

    blocks: of position, velocity and effort; fixed: (n_bytes,) bool, the bytes that hold frame,
    names and lengths.
    """

    names: tuple[str, ...]
    blocks: tuple[Block, ...]
    fixed: np.ndarray

    @classmethod
    def of(cls, data: bytes) -> "VectorLayout":
        """Read the layout from a serialized message; InputError when it is no JointState."""
        message = deserialized(data, JointState)
        layout = layout_in(data, message)
        if layout is None:
            raise InputError("expected little-endian messages with names in UTF-8, got others")
        fixed = np.zeros(len(data), bool)
        for part in layout.parts:
            fixed[part] = True
        for part in (STAMP, *(block.bytes for block in layout.blocks.values())):
            fixed[part] = False
        return cls(tuple(message.name), tuple(layout.blocks.values()), fixed)

    def fits(self, messages: np.ndarray, first: np.ndarray) -> np.ndarray:
        """Return which messages (n, n_bytes) have the frame, names and lengths of the first."""
        return ~((messages != first) & self.fixed).any(axis=1)

    def values(self, messages: np.ndarray, i_field: int) -> np.ndarray:
        """Return field 0, 1 or 2 of messages (n, n_bytes) uint8: (n, length) float64."""
        block = self.blocks[i_field]
        numbers = np.ascontiguousarray(messages[:, block.bytes]).view(block.dtype)
        return numbers.reshape(len(messages), block.length)


def image_array(data: bytes) -> np.ndarray:
    """Return the picture of a serialized sensor_msgs/Image.

    mono8: (height, width) uint8; 32FC1: (height, width) float32. Raises InputError for any other.
    """
    image = deserialized(data, Image)
    kinds: dict[str, np.dtype[Any]] = {"mono8": np.dtype("u1"), "32FC1": np.dtype("<f4")}
    if image.encoding not in kinds or image.is_bigendian:
        raise InputError(f"expected a little-endian mono8 or 32FC1 image, got {image.encoding!r}")
    kind, row_bytes = kinds[image.encoding], image.width * kinds[image.encoding].itemsize
    if len(image.data) != image.step * image.height or image.step < row_bytes:
        raise InputError(
            f"expected {image.height} rows of {image.width} {image.encoding}, "
            f"got {len(image.data)} bytes in steps of {image.step}"
        )
    rows = np.frombuffer(image.data, np.uint8).reshape(image.height, image.step)
    return np.ascontiguousarray(rows[:, :row_bytes]).view(kind)


def stamp_of(message: bytes) -> tuple[int, int]:
    """Return seconds and nanoseconds of a message that begins with a header, as they are.

    Raises InputError for a message that is too short to have them.
    """
    if len(message) < STAMP.stop or message[:2] not in _ORDERS:
        raise InputError(f"expected a message with a header, got {len(message)} bytes")
    seconds, nanoseconds = struct.unpack_from(f"{_ORDERS[message[:2]]}iI", message, STAMP.start)
    return seconds, nanoseconds


def stamp_ns_of(message: bytes) -> int:
    """Return the stamp of a message that begins with a header; InputError for an impossible one."""
    return checked_stamp(*stamp_of(message))
