"""Pictures of one size, carried by sensor_msgs/Image."""

import numpy as np
from rclpy.node import Node
from sensor_msgs.msg import Image

from lockstep.wire.codec import Writer
from lockstep.wire.publisher import RepeatingPublisher


class ImageBytes:
    """Serializes pictures of one size and encoding."""

    def __init__(self, message: Image) -> None:
        """message: all but stamp and data, taken over."""
        message.data = bytes(message.height * message.step)
        self._write = Writer(message)

    def of(self, stamp_ns: int, picture: np.ndarray) -> bytes:
        """Return the message of a contiguous picture of height x step bytes."""
        return self._write(stamp_ns, picture.view(np.uint8).ravel())


class ImagePublisher(RepeatingPublisher):
    """Publishes contiguous pictures, of height x step bytes, of one size and encoding."""

    def __init__(self, node: Node, topic: str, message: Image) -> None:
        """message: all but stamp and data, taken over."""
        super().__init__(node, Image, topic, ImageBytes(message).of)
