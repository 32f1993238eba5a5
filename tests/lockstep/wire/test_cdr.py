"""Messages as bytes: what ROS and other people's libraries make of them, and the stamps in them."""

import itertools

import numpy as np
import pytest
from rclpy.serialization import deserialize_message
from rosbags.typesys import Stores, get_typestore
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import CameraInfo, Image, JointState

from eye_plant.camera.config import CameraConfig
from eye_plant.messages import camera_info
from lockstep import InputError
from lockstep.wire.cdr import VectorLayout, deserialized, serialized, stamp_ns_of, stamp_of
from lockstep.wire.stamps import to_time
from lockstep.wire.vectors import vector_message

STORE = get_typestore(Stores.ROS2_JAZZY)


@pytest.mark.parametrize("n_names", [1, 2, 5, 12])
@pytest.mark.parametrize("has", [*itertools.product((0, 1), repeat=2)])
def test_no_byte_of_a_vector_is_there_that_no_reader_expects(n_names, has) -> None:
    names = [f"{'x' * i}{i}" for i in range(n_names)]
    parts = [np.ones(n_names * there) for there in (1, *has)]
    header = STORE.types["std_msgs/msg/Header"](
        STORE.types["builtin_interfaces/msg/Time"](0, 0), ""
    )
    vector = STORE.types["sensor_msgs/msg/JointState"](header, names, *parts)
    expected = bytes(STORE.serialize_cdr(vector, "sensor_msgs/msg/JointState"))
    assert serialized(vector_message(0, names, *parts)) == expected


@pytest.mark.parametrize(("height", "width"), [(2, 3), (3, 5), (240, 320)])
def test_a_picture_ends_with_its_last_pixel(height: int, width: int) -> None:
    message = Image(height=height, width=width, encoding="mono8", step=width)
    message.data = b"\x07" * (height * width)
    data = serialized(message)
    image = STORE.deserialize_cdr(data, "sensor_msgs/msg/Image")
    assert image.data.tobytes() == b"\x07" * (height * width)
    assert data == bytes(STORE.serialize_cdr(image, "sensor_msgs/msg/Image"))


def test_arrays_and_messages_within_a_message_are_gone_through() -> None:
    message = camera_info(CameraConfig(), 1, 0.056)
    data = serialized(message)
    assert deserialize_message(data, CameraInfo) == message
    read = STORE.deserialize_cdr(data, "sensor_msgs/msg/CameraInfo")
    assert data == bytes(STORE.serialize_cdr(read, "sensor_msgs/msg/CameraInfo"))


def test_a_message_of_numbers_alone() -> None:
    clock = Clock(clock=to_time(7_000_000_008))
    assert serialized(clock) == bytes([0, 1, 0, 0, 7, 0, 0, 0, 8, 0, 0, 0])


@pytest.mark.parametrize("n_bytes", [0, 1, 4, 11])
def test_a_message_too_short_for_a_stamp_is_refused(n_bytes: int) -> None:
    with pytest.raises(InputError, match=f"expected a message with a header, got {n_bytes} bytes"):
        stamp_of(serialized(vector_message(1, "a", [1.0]))[:n_bytes])


@pytest.mark.parametrize("little_endian", [False, True])
def test_the_stamp_is_read_in_both_byte_orders(little_endian: bool) -> None:
    clock = STORE.types["rosgraph_msgs/msg/Clock"](STORE.types["builtin_interfaces/msg/Time"](7, 8))
    data = STORE.serialize_cdr(clock, "rosgraph_msgs/msg/Clock", little_endian=little_endian)
    assert stamp_of(bytes(data)) == (7, 8)
    assert stamp_ns_of(bytes(data)) == 7_000_000_008


def test_an_impossible_stamp_is_refused() -> None:
    data = serialized(vector_message(1, "a", [1.0]))
    with pytest.raises(InputError, match="stamp: expected"):
        stamp_ns_of(data[:8] + (10**9).to_bytes(4, "little") + data[12:])


@pytest.mark.parametrize("kind", [JointState, Image])
@pytest.mark.parametrize("topic", ["", "eye"])
def test_bytes_that_are_no_message_are_refused(kind: type, topic: str) -> None:
    whole = serialized(kind())
    where = f"^{topic}: expected" if topic else "^expected"
    for n_bytes in (0, 3, 11, len(whole) - 1):
        with pytest.raises(
            InputError, match=f"{where} a serialized {kind.__name__}, got {n_bytes} bytes"
        ):
            deserialized(whole[:n_bytes], kind, topic)


@pytest.mark.parametrize("name", [b"n\xff\xfee", b"n\0me"])
def test_a_layout_is_that_of_the_bytes_or_none(name: bytes) -> None:
    data = serialized(vector_message(1, ["name"], [1.0]))
    assert VectorLayout.of(data).names == ("name",)
    with pytest.raises(InputError, match="expected little-endian messages with names in UTF-8"):
        VectorLayout.of(data.replace(b"name", name))
