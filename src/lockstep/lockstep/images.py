"""Pictures of one size, carried by sensor_msgs/Image."""

import numpy as np
from rclpy.node import Node
from rclpy.publisher import Publisher
from sensor_msgs.msg import Image

from lockstep.qos import LOCKSTEP_QOS
from lockstep.stamped_bytes import StampedBytes

_LARGEST_PRIME_BYTE = 251  # no period of a picture's rows, so that the pattern is found once only


class ImagePublisher:
    """Publishes pictures of one size and encoding on one topic, and can repeat the last one."""

    def __init__(self, node: Node, topic: str, message: Image) -> None:
        """message: all but stamp and data; it is left as it is, but for its data."""
        self.publisher: Publisher = node.create_publisher(Image, topic, LOCKSTEP_QOS)
        n_bytes = message.height * message.step
        place = (np.arange(n_bytes) % _LARGEST_PRIME_BYTE).astype(np.uint8)
        message.data = place.tobytes()
        self._bytes = StampedBytes(message, place)
        self._last = b""

    def publish(self, stamp_ns: int, picture: np.ndarray) -> None:
        """Publish a contiguous picture of height x step bytes."""
        self._last = self._bytes.fill(stamp_ns, picture.view(np.uint8).ravel())
        self.publisher.publish(self._last)

    def repeat(self) -> None:
        """Publish the last picture again, if there was one."""
        if self._last:
            self.publisher.publish(self._last)
