"""Writing and reading numbers in the bytes of a message, against rclpy's own serialization."""

import itertools
from collections.abc import Iterator
from typing import Any
from unittest import mock

import numpy as np
import pytest
from rclpy.node import Node
from rosbags.typesys import Stores, get_typestore
from sensor_msgs.msg import Image, JointState

from eye_plant.camera.config import CameraConfig
from eye_plant.messages import camera_info
from lockstep import InputError
from lockstep.wire import codec
from lockstep.wire.cdr import deserialized, serialized
from lockstep.wire.codec import Reader, Writer
from lockstep.wire.stamps import to_time
from lockstep.wire.vectors import VectorPublisher, values_of, vector_message
from tests.node_harness import Graph

NAMES = ["a", "longer", ""]
STAMPS_NS = (3, 1_500_000_000, 7)
EACH_LAYOUT = pytest.mark.parametrize("has", [*itertools.product((False, True), repeat=3)])


def vector(stamp_ns: int, has: tuple[bool, ...] = (True, False, False)) -> JointState:
    """Return a vector of random numbers, one row per field that it has."""
    rows = np.random.default_rng(stamp_ns).normal(size=(3, len(NAMES)))
    fields = [row if is_there else () for row, is_there in zip(rows, has, strict=True)]
    return vector_message(stamp_ns, NAMES, *fields)


def picture(stamp_ns: int, encoding: str = "mono8", n_bytes: int = 15) -> Image:
    """Return a picture of random pixels."""
    message = Image(height=3, width=5, step=5, encoding=encoding)
    message.header.stamp, message.header.frame_id = to_time(stamp_ns), "left_eye"
    message.data = np.random.default_rng(stamp_ns).integers(0, 256, n_bytes, np.uint8).tobytes()
    return message


def fields_of(read: Any, kind: type) -> dict[str, Any]:
    """Return the fields of what was read, except the header, whose stamp is read by itself."""
    names = [name for name in kind.get_fields_and_field_types() if name != "header"]  # type: ignore[attr-defined]
    return {n: v if isinstance(v := getattr(read, n), str | int) else list(v) for n in names}


@pytest.fixture
def learned() -> Iterator[mock.Mock]:
    """Count the messages that are deserialized as a whole."""
    with mock.patch.object(codec, "deserialized", side_effect=deserialized) as counted:
        yield counted


@EACH_LAYOUT
def test_vectors_have_the_bytes_of_rclpy(has: tuple[bool, ...]) -> None:
    write = Writer(vector(0, has))
    for stamp_ns in STAMPS_NS:
        message = vector(stamp_ns, has)
        values = [f for f in (message.position, message.velocity, message.effort) if len(f)]
        assert write(stamp_ns, *values) == serialized(message)


def test_pictures_and_what_changes_its_stamp_alone() -> None:
    write = Writer(picture(0))
    for stamp_ns in STAMPS_NS:
        expected = picture(stamp_ns)
        assert write(stamp_ns, np.frombuffer(expected.data, np.uint8)) == serialized(expected)
    info = camera_info(CameraConfig(), 1, 0.056)
    written = Writer(info)(7_000_000_008)
    info.header.stamp = to_time(7_000_000_008)
    assert written == serialized(info)


def test_numbers_travel_bit_for_bit_and_stay() -> None:
    write = Writer(vector_message(0, "abc", [0.0] * 3))
    values = np.array([np.nan, -np.inf, 5e-324])
    first = write(0, values)
    assert first == serialized(vector_message(0, "abc", values))
    write(1, [1.0, 2.0, 3.0])
    assert first == serialized(vector_message(0, "abc", values))


@EACH_LAYOUT
def test_vectors_are_deserialized_once(learned: mock.Mock, has: tuple[bool, ...]) -> None:
    read = Reader(JointState, "vector")
    for stamp_ns in STAMPS_NS:
        message = vector(stamp_ns, has)
        assert fields_of(read(serialized(message)), JointState) == fields_of(message, JointState)
    assert learned.call_count == 1


def test_a_change_of_layout_is_noticed_and_taken_over(learned: mock.Mock) -> None:
    read = Reader(Image, "picture")
    kinds = [("mono8", 15), ("mono9", 15), ("mono9", 15), ("mono9", 16), ("mono9", 0), ("mono9", 1)]
    for stamp_ns, (encoding, n_bytes) in enumerate(kinds):
        message = picture(stamp_ns, encoding, n_bytes)
        assert fields_of(read(serialized(message)), Image) == fields_of(message, Image)
    assert learned.call_count == 6


def test_a_single_message_of_another_layout_displaces_nothing() -> None:
    read = Reader(JointState, "vector")
    foreign = serialized(vector_message(1, [str(i) for i in range(5000)], np.zeros(5000)))
    read(serialized(vector(0)))
    with mock.patch.object(codec, "layout_in", side_effect=codec.layout_in) as laid_out:
        for stamp_ns in (3, 7, 9):
            assert list(read(foreign).name) == [str(i) for i in range(5000)]
            read_again = read(serialized(vector(stamp_ns)))
            assert fields_of(read_again, JointState) == fields_of(vector(stamp_ns), JointState)
    assert laid_out.call_count == 0


def test_the_other_byte_order_is_read_too() -> None:
    store = get_typestore(Stores.ROS2_JAZZY)
    kind = "sensor_msgs/msg/JointState"
    foreign = store.deserialize_cdr(serialized(vector(5)), kind)
    read = Reader(JointState, "vector")
    for little_endian in (True, False, False, True):
        data = bytes(store.serialize_cdr(foreign, kind, little_endian=little_endian))
        values = values_of(read(data), NAMES, "vector")
        np.testing.assert_array_equal(values, vector(5).position)


@pytest.mark.parametrize("name", [b"l\xff\xfeger", b"l\0nger"])
def test_odd_text_is_read_as_rclpy_reads_it(name: bytes) -> None:
    data = serialized(vector(5)).replace(b"longer", name)
    read = Reader(JointState, "vector")
    read(serialized(vector(5)))
    assert fields_of(read(data), JointState) == fields_of(
        deserialized(data, JointState), JointState
    )


def test_neither_a_refusal_nor_the_next_message_changes_what_is_read() -> None:
    read = Reader(JointState, "eye")
    data = serialized(vector(1))
    first = read(data)
    for n_bytes in (0, 3, 11, 40):
        with pytest.raises(InputError, match=f"eye: expected a serialized .*, got {n_bytes} bytes"):
            read(data[:n_bytes])
    read(serialized(vector(2)))
    for same in (first, read(data)):
        assert fields_of(same, JointState) == fields_of(vector(1), JointState)


def test_a_repeat_sends_the_last_one_again_and_nothing_before_the_first(graph: Graph) -> None:
    publisher = VectorPublisher(graph.add(lambda **kwargs: Node("codec", **kwargs)), "v", ("a",))
    with mock.patch.object(publisher, "publisher") as recorder:
        publisher.repeat()
        assert recorder.publish.call_count == 0
        publisher.publish(5, (1.0,))
        publisher.repeat()
    first, second = recorder.publish.call_args_list
    assert first == second
