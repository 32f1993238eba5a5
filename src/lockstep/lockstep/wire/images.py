"""Pictures of one size, carried by sensor_msgs/Image."""

from dataclasses import dataclass

import numpy as np
from rclpy.node import Node
from rclpy.publisher import Publisher
from sensor_msgs.msg import Image

from lockstep.errors import InputError
from lockstep.wire.cdr import Alike, ImageLayout, StampedBytes, stamp_ns_of
from lockstep.wire.padding import serialized
from lockstep.wire.qos import LOCKSTEP_QOS


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
        message.data = bytes(message.height * message.step)
        data = serialized(message)
        self._layout = StampedBytes(data, [(np.uint8, ImageLayout.of(bytes(data)).block)])

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
        self._alike: Alike | None = None
        self._layout: ImageLayout

    def read(self, data: bytes) -> Picture:
        """Return what a message holds, quickly when it is laid out like the one before.

        Raises InputError for bytes that are no sensor_msgs/Image, and for its stamp.
        """
        if self._alike is None or not self._alike.fits(data):
            self._learn(data)
        layout = self._layout
        start, n_bytes = layout.block
        return Picture(
            stamp_ns_of(data),
            layout.height,
            layout.width,
            layout.encoding,
            layout.is_bigendian,
            layout.step,
            np.frombuffer(data, np.uint8, n_bytes, start) if n_bytes else np.zeros(0, np.uint8),
        )

    def _learn(self, data: bytes) -> None:
        try:
            layout = ImageLayout.of(data)
        except InputError as error:
            raise InputError(f"{self._topic}: {error}") from error
        self._layout = layout
        start, n_bytes = layout.block
        self._alike = Alike(data, [slice(start, start + n_bytes)])
