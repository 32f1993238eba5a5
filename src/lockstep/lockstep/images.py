"""Pictures of one size, carried by sensor_msgs/Image."""

from dataclasses import dataclass

import numpy as np
from rclpy.node import Node
from rclpy.publisher import Publisher
from sensor_msgs.msg import Image

from lockstep.qos import LOCKSTEP_QOS
from lockstep.stamped_bytes import StampedBytes, deserialized
from lockstep.stamps import checked_ns

_LARGEST_PRIME_BYTE = 251  # no period of a picture's rows, so that the pattern is found once only


@dataclass(frozen=True, slots=True)
class Picture:
    """What a message of a picture holds, under the names of sensor_msgs/Image.

    data: (n_bytes,) uint8, not to be written to.
    """

    stamp_ns: int
    height: int
    width: int
    encoding: str
    is_bigendian: int
    step: int
    data: np.ndarray


class ImageBytes:
    """Serializes pictures of one size and encoding."""

    def __init__(self, message: Image) -> None:
        """message: all but stamp and data; it is left as it is, but for its data."""
        self._layout = _layout(message, message.height * message.step)

    def of(self, stamp_ns: int, picture: np.ndarray) -> bytes:
        """Return the message of a contiguous picture of height x step bytes."""
        return self._layout.fill(stamp_ns, picture.view(np.uint8).ravel())


class ImagePublisher:
    """Publishes pictures of one size and encoding on one topic, and can repeat the last one."""

    def __init__(self, node: Node, topic: str, message: Image) -> None:
        """message: all but stamp and data; it is left as it is, but for its data."""
        self.publisher: Publisher = node.create_publisher(Image, topic, LOCKSTEP_QOS)
        self._bytes = ImageBytes(message)
        self._last = b""

    def publish(self, stamp_ns: int, picture: np.ndarray) -> None:
        """Publish a contiguous picture of height x step bytes."""
        self._last = self._bytes.of(stamp_ns, picture)
        self.publisher.publish(self._last)

    def repeat(self) -> None:
        """Publish the last picture again, if there was one."""
        if self._last:
            self.publisher.publish(self._last)


class ImageReader:
    """Reads the serialized pictures of one topic."""

    def __init__(self, topic: str) -> None:
        """topic: for error messages."""
        self._topic = topic
        self._last = Image()
        self._layout: StampedBytes | None = None

    def read(self, data: bytes) -> Picture:
        """Return what a message holds, quickly when it is laid out like the one before.

        Raises InputError for bytes that are no sensor_msgs/Image, and for its stamp.
        """
        found = self._layout.read(data) if self._layout is not None else None
        if found is None:
            message = deserialized(data, Image, self._topic)
            stamp_ns = checked_ns(message.header.stamp)
            self._last = message
            picture = np.asarray(message.data, np.uint8)
            self._layout = None
            if picture.size:
                layout = _layout(message, picture.size)
                self._layout = layout if layout.expect(data) else None
        else:
            stamp_ns, (picture,) = found
        last = self._last
        return Picture(
            stamp_ns, last.height, last.width, last.encoding, last.is_bigendian, last.step, picture
        )


def _layout(message: Image, n_bytes: int) -> StampedBytes:
    """Return the message with so many bytes as data; the message's own data are replaced."""
    place = (np.arange(n_bytes) % _LARGEST_PRIME_BYTE).astype(np.uint8)
    message.data = place.tobytes()
    return StampedBytes(message, place)
