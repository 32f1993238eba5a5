"""A topic's messages as they are sent: serialized, and once more when somebody waits."""

from collections.abc import Callable
from typing import Any

from rclpy.node import Node
from rclpy.publisher import Publisher

from lockstep.wire.qos import LOCKSTEP_QOS


class RepeatingPublisher:
    """Publishes messages on one topic, and can repeat the last one."""

    def __init__(self, node: Node, kind: type, topic: str, to_bytes: Callable[..., bytes]) -> None:
        """to_bytes: returns the serialized message of a stamp and of what is in the message."""
        self.publisher: Publisher = node.create_publisher(kind, topic, LOCKSTEP_QOS)
        self._to_bytes = to_bytes
        self._last = b""

    def publish(self, stamp_ns: int, *values: Any) -> None:
        """Publish the message of a stamp and values."""
        self._last = self._to_bytes(stamp_ns, *values)
        self.publisher.publish(self._last)

    def repeat(self) -> None:
        """Publish the last message again, if there was one."""
        if self._last:
            self.publisher.publish(self._last)
