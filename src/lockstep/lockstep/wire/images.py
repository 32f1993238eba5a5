"""Pictures of one size, carried by sensor_msgs/Image."""

import numpy as np
from rclpy.node import Node
from rclpy.publisher import Publisher
from sensor_msgs.msg import Image

from lockstep.wire.codec import writer_of
from lockstep.wire.qos import LOCKSTEP_QOS


class ImageBytes:
    """Serializes pictures of one size and encoding."""

    def __init__(self, message: Image) -> None:
        """message: all but stamp and data, taken over."""
        message.data = bytes(message.height * message.step)
        self._write = writer_of(message)

    def of(self, stamp_ns: int, picture: np.ndarray) -> bytes:
        """Return the message of a contiguous picture of height x step bytes."""
        return self._write(stamp_ns, picture.view(np.uint8).ravel())


class ImagePublisher:
    """Publishes pictures of one size and encoding on one topic, and can repeat the last one."""

    def __init__(self, node: Node, topic: str, message: Image) -> None:
        """message: all but stamp and data, taken over."""
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
