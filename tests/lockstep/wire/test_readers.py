"""What is read from bytes is what was serialized, and most of it without parsing."""

import itertools
from collections.abc import Iterator
from typing import Any
from unittest import mock

import numpy as np
import pytest
from rosbags.typesys import Stores, get_typestore

from lockstep.errors import InputError
from lockstep.wire import cdr
from lockstep.wire.images import ImageReader
from lockstep.wire.vectors import VectorReader, values_of

STORE = get_typestore(Stores.ROS2_JAZZY)
NAMES = ["a", "longer", ""]
SIZES = {"height": 3, "width": 5, "step": 5}


def header(stamp_ns: int, frame_id: str = "") -> Any:
    time = STORE.types["builtin_interfaces/msg/Time"](*divmod(stamp_ns, 10**9))
    return STORE.types["std_msgs/msg/Header"](time, frame_id)


def vector(stamp_ns: int, has: tuple[bool, ...] = (True, False, False), **kwargs: Any) -> bytes:
    """Return a serialized vector of random numbers, one row per field that it has."""
    rows = np.random.default_rng(stamp_ns).normal(size=(3, len(NAMES)))
    fields = [row if is_there else np.zeros(0) for row, is_there in zip(rows, has, strict=True)]
    kind = "sensor_msgs/msg/JointState"
    message = STORE.types[kind](header(stamp_ns, "head"), NAMES, *fields)
    return bytes(STORE.serialize_cdr(message, kind, **kwargs))


def picture(stamp_ns: int, encoding: str = "mono8", n_bytes: int = 15) -> bytes:
    data = np.random.default_rng(stamp_ns).integers(0, 256, n_bytes, np.uint8)
    kind = "sensor_msgs/msg/Image"
    message = STORE.types[kind](
        header(stamp_ns, "left_eye"), encoding=encoding, is_bigendian=0, data=data, **SIZES
    )
    return bytes(STORE.serialize_cdr(message, kind))


@pytest.fixture
def parsed() -> Iterator[mock.Mock]:
    """Count the messages whose layout is parsed."""
    with mock.patch.object(cdr, "_Cursor", side_effect=cdr._Cursor) as counted:
        yield counted


@pytest.mark.parametrize("has", [*itertools.product((False, True), repeat=3)][1:])
def test_vectors_of_one_layout_are_parsed_once(parsed: mock.Mock, has: tuple[bool, ...]) -> None:
    reader = VectorReader("vector")
    for stamp_ns in (3, 1_500_000_000, 7):
        read = reader.read(vector(stamp_ns, has))
        rows = np.random.default_rng(stamp_ns).normal(size=(3, len(NAMES)))
        assert (read.stamp_ns, read.name) == (stamp_ns, NAMES)
        for field, row, is_there in zip(
            (read.position, read.velocity, read.effort), rows, has, strict=True
        ):
            assert field.tolist() == (row.tolist() if is_there else [])
    assert parsed.call_count == 1


def test_pictures_of_one_layout_are_parsed_once(parsed: mock.Mock) -> None:
    reader = ImageReader("picture")
    for stamp_ns in (3, 1_500_000_000, 7):
        read = reader.read(picture(stamp_ns))
        data = np.random.default_rng(stamp_ns).integers(0, 256, 15, np.uint8)
        assert (read.stamp_ns, read.encoding, read.is_bigendian) == (stamp_ns, "mono8", 0)
        assert {name: getattr(read, name) for name in SIZES} == SIZES
        assert read.data.tobytes() == data.tobytes()
    assert parsed.call_count == 1


def test_a_change_of_layout_is_noticed_and_taken_over(parsed: mock.Mock) -> None:
    pictures = ImageReader("picture")
    for data in (picture(1), picture(2, "mono9"), picture(3, "mono9"), picture(4, "mono9", 16)):
        pictures.read(data)
    assert parsed.call_count == 3
    assert pictures.read(picture(5, "mono9", 0)).data.size == 0
    assert pictures.read(picture(6, "mono9", 1)).data.size == 1
    vectors = VectorReader("vector")
    assert vectors.read(vector(1, (False, False, False))).position.size == 0
    assert vectors.read(vector(1, (True, False, True))).velocity.size == 0
    assert vectors.read(vector(1, (True, True, False))).velocity.size == len(NAMES)


def test_the_other_byte_order_is_read_too(parsed: mock.Mock) -> None:
    reader = VectorReader("vector")
    for little_endian in (True, False, False, True):
        read = reader.read(vector(5, little_endian=little_endian))
        expected = np.random.default_rng(5).normal(size=(3, len(NAMES)))[0]
        np.testing.assert_array_equal(values_of(read, NAMES, "vector"), expected)
    assert parsed.call_count == 3


@pytest.mark.parametrize("reader", [VectorReader("eye"), ImageReader("eye")])
@pytest.mark.parametrize("n_bytes", [0, 3, 11, 40])
def test_bytes_that_are_no_message_are_refused(
    reader: VectorReader | ImageReader, n_bytes: int
) -> None:
    whole = vector(1) if isinstance(reader, VectorReader) else picture(1)
    with pytest.raises(InputError, match=f"eye: expected a serialized .*, got {n_bytes} bytes"):
        reader.read(whole[:n_bytes])


def _never(data: bytes) -> bytes:
    """Return the message with an impossible stamp."""
    return data[:8] + (10**9).to_bytes(4, "little") + data[12:]


@pytest.mark.parametrize("is_known", [False, True])
def test_an_impossible_stamp_is_refused(is_known: bool) -> None:
    reader = VectorReader("vector")
    if is_known:
        reader.read(vector(1))
    with pytest.raises(InputError, match="stamp: expected"):
        reader.read(_never(vector(1)))


def test_what_was_refused_leaves_no_trace() -> None:
    pictures, vectors = ImageReader("picture"), VectorReader("vector")
    before = pictures.read(picture(1)), vectors.read(vector(1))
    with pytest.raises(InputError, match="stamp: expected"):
        pictures.read(_never(picture(1, "mono9", 20)))
    with pytest.raises(InputError, match="stamp: expected"):
        vectors.read(_never(vector(1, (True, True, True))))
    after = pictures.read(picture(1)), vectors.read(vector(1))
    assert repr(after) == repr(before)


def test_what_was_read_stays_when_the_next_is_read() -> None:
    reader = VectorReader("vector")
    reader.read(vector(1))
    before = reader.read(vector(2))
    kept = before.position.tolist()
    reader.read(vector(3))
    assert before.position.tolist() == kept
