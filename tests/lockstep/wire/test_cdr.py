"""Messages that are filled in as bytes are the messages that ROS would have made."""

import itertools
from collections.abc import Iterator

import numpy as np
import pytest
from rclpy.context import Context
from rclpy.node import Node
from rclpy.serialization import deserialize_message
from rosbags.typesys import Stores, get_typestore
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import CameraInfo, Image, JointState

from eye_plant.camera.config import CameraConfig
from eye_plant.messages import camera_info
from lockstep.errors import InputError
from lockstep.wire.cdr import StampedBytes, clock_bytes, stamp_of
from lockstep.wire.images import ImagePublisher
from lockstep.wire.padding import serialized
from lockstep.wire.stamps import to_time
from lockstep.wire.vectors import VectorBytes, VectorPublisher, vector_message


@pytest.fixture
def node() -> Iterator[Node]:
    context = Context()
    context.init(domain_id=97)
    node = Node("cdr", context=context)
    yield node
    node.destroy_node()
    context.try_shutdown()


class _Recorder:
    """Stands in for a publisher."""

    def __init__(self) -> None:
        self.sent: list[bytes] = []

    def publish(self, message: bytes) -> None:
        self.sent.append(message)


@pytest.mark.parametrize("n_names", [1, 2, 5, 12])
def test_a_vector_of_any_layout_is_the_vector_that_was_meant(node: Node, n_names: int) -> None:
    names = [f"{'x' * i}{i}" for i in range(n_names)]
    publisher = VectorPublisher(node, "vector", names)
    publisher.publisher = recorder = _Recorder()
    values = np.random.default_rng(0).normal(size=(3, n_names))
    for has_velocity, has_effort in itertools.product((False, True), repeat=2):
        velocity = values[1] if has_velocity else ()
        effort = values[2] if has_effort else ()
        for stamp_ns in (0, 7_123_456_789):
            publisher.publish(stamp_ns, tuple(values[0]), velocity, effort)
            expected = vector_message(stamp_ns, names, values[0], velocity, effort)
            assert deserialize_message(recorder.sent[-1], JointState) == expected


def test_a_vector_may_hold_what_is_no_number(node: Node) -> None:
    publisher = VectorPublisher(node, "vector", ("a", "b"))
    publisher.publisher = recorder = _Recorder()
    publisher.publish(0, (np.nan, -np.inf))
    position = deserialize_message(recorder.sent[0], JointState).position
    np.testing.assert_array_equal(position, [np.nan, -np.inf])


def test_a_picture_is_the_picture_that_was_meant(node: Node) -> None:
    message = Image(height=5, width=60, encoding="32FC1", step=240)
    message.header.frame_id = "left_eye"
    publisher = ImagePublisher(node, "picture", message)
    publisher.publisher = recorder = _Recorder()
    picture = np.random.default_rng(0).normal(size=(5, 60)).astype(np.float32)
    publisher.publish(3_000_000_004, picture)
    received = deserialize_message(recorder.sent[0], Image)
    assert (received.header.stamp.sec, received.header.stamp.nanosec) == (3, 4)
    assert (received.header.frame_id, received.encoding) == ("left_eye", "32FC1")
    assert (received.height, received.width, received.step) == (5, 60, 240)
    assert bytes(received.data) == picture.tobytes()


def test_what_was_sent_does_not_change_when_the_next_is_filled_in() -> None:
    vector = VectorBytes(("a",))
    first = vector.of(0, [1.0])
    vector.of(1, [2.0])
    assert list(deserialize_message(first, JointState).position) == [1.0]


def test_a_repeat_sends_the_last_one_again_and_nothing_before_the_first(node: Node) -> None:
    vector = VectorPublisher(node, "vector", ("a",))
    vector.publisher = vectors = _Recorder()
    image = ImagePublisher(node, "picture", Image(height=2, width=3, encoding="mono8", step=3))
    image.publisher = images = _Recorder()
    vector.repeat()
    image.repeat()
    assert vectors.sent == images.sent == []
    vector.publish(5, (1.0,))
    image.publish(5, np.zeros((2, 3), np.uint8))
    vector.repeat()
    image.repeat()
    assert vectors.sent[0] == vectors.sent[1]
    assert images.sent[0] == images.sent[1]


@pytest.mark.parametrize("n_names", [1, 2, 5, 12])
@pytest.mark.parametrize(
    ("has_velocity", "has_effort"), [*itertools.product((False, True), repeat=2)]
)
def test_no_byte_is_there_that_no_reader_expects(
    node: Node, n_names: int, has_velocity: bool, has_effort: bool
) -> None:
    names = [f"{'x' * i}{i}" for i in range(n_names)]
    publisher = VectorPublisher(node, "vector", names)
    publisher.publisher = recorder = _Recorder()
    store = get_typestore(Stores.ROS2_JAZZY)
    parts = [np.ones(n_names * there) for there in (True, has_velocity, has_effort)]
    header = store.types["std_msgs/msg/Header"](
        store.types["builtin_interfaces/msg/Time"](0, 0), ""
    )
    vector = store.types["sensor_msgs/msg/JointState"](header, names, *parts)
    expected = bytes(store.serialize_cdr(vector, "sensor_msgs/msg/JointState"))
    publisher.publish(0, *parts)
    found = recorder.sent[0]
    assert found == expected


@pytest.mark.parametrize(("height", "width"), [(2, 3), (3, 5), (240, 320)])
def test_a_picture_ends_with_its_last_pixel(
    node: Node, height: int, width: int, capfd: pytest.CaptureFixture
) -> None:
    message = Image(height=height, width=width, encoding="mono8", step=width)
    publisher = ImagePublisher(node, "picture", message)
    publisher.publisher = recorder = _Recorder()
    publisher.publish(0, np.full((height, width), 7, np.uint8))
    store = get_typestore(Stores.ROS2_JAZZY)
    image = store.deserialize_cdr(recorder.sent[0], "sensor_msgs/msg/Image")
    assert image.data.tobytes() == b"\x07" * (height * width)
    assert recorder.sent[0] == bytes(store.serialize_cdr(image, "sensor_msgs/msg/Image"))
    # The middleware complains there about messages that it is given and cannot read.
    assert capfd.readouterr().err == ""


def test_a_message_without_numbers_changes_its_stamp_alone() -> None:
    message = camera_info(CameraConfig(), 1, 0.056)
    message.header.stamp = to_time(7_000_000_008)
    store = get_typestore(Stores.ROS2_JAZZY)
    filled = StampedBytes(serialized(camera_info(CameraConfig(), 1, 0.056))).fill(7_000_000_008)
    assert deserialize_message(filled, CameraInfo) == message
    read = store.deserialize_cdr(filled, "sensor_msgs/msg/CameraInfo")
    assert filled == bytes(store.serialize_cdr(read, "sensor_msgs/msg/CameraInfo"))


@pytest.mark.parametrize("n_bytes", [0, 1, 4, 11])
def test_a_message_too_short_for_a_stamp_is_refused(n_bytes: int) -> None:
    with pytest.raises(InputError, match=f"expected a message with a header, got {n_bytes} bytes"):
        stamp_of(clock_bytes(1)[:n_bytes])


def test_a_clock_is_the_clock_that_was_meant() -> None:
    clock = deserialize_message(clock_bytes(7_000_000_008), Clock)
    assert clock == Clock(clock=to_time(7_000_000_008))
