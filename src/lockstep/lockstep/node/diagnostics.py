"""What each node says of itself on /diagnostics, once a second."""

import time
from collections.abc import Callable

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.clock import Clock, ClockType
from rclpy.node import Node

PERIOD_S = 1.0
TOPIC = "/diagnostics"
# A flood of bad input must not become a flood of log lines.
_MIN_S_BETWEEN_LOGS = 1.0


class Diagnostics:
    """Counts what a node did and refused, and publishes it at 1 Hz on steady time."""

    def __init__(self, node: Node, more: Callable[[], dict[str, str]] = dict) -> None:
        """more: further values to publish, by name."""
        self._node = node
        self._more = more
        self._n_done = 0
        self._n_done_before = 0
        self.n_refused = 0
        self.last_refused = ""
        self._logged_s = -_MIN_S_BETWEEN_LOGS
        self._n_not_logged = 0
        self._published_s = time.monotonic()
        self._publisher = node.create_publisher(DiagnosticArray, TOPIC, 10)
        node.create_timer(PERIOD_S, self.publish, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def count(self) -> None:
        """Count one observation handled."""
        self._n_done += 1

    def refuse(self, reason: str) -> None:
        """Count a refused input, and log it (at most once a second, with the count of the rest)."""
        self.n_refused += 1
        self.last_refused = reason
        now_s = time.monotonic()
        if now_s - self._logged_s < _MIN_S_BETWEEN_LOGS:
            self._n_not_logged += 1
            return
        more = f" (and {self._n_not_logged} more since)" if self._n_not_logged else ""
        self._node.get_logger().error(f"refused: {reason}{more}")
        self._logged_s, self._n_not_logged = now_s, 0

    def publish(self) -> None:
        """Publish the state of the node now."""
        now_s = time.monotonic()
        elapsed_s = max(now_s - self._published_s, 1e-9)
        rate_hz = (self._n_done - self._n_done_before) / elapsed_s
        self._n_done_before, self._published_s = self._n_done, now_s
        values = {
            "rate_hz": f"{rate_hz:.1f}",
            "observations": str(self._n_done),
            "refused_inputs": str(self.n_refused),
            "last_refused": self.last_refused,
        } | self._more()
        status = DiagnosticStatus(
            level=DiagnosticStatus.WARN if self.n_refused else DiagnosticStatus.OK,
            name=self._node.get_fully_qualified_name(),
            message="inputs were refused" if self.n_refused else "running",
            hardware_id=self._node.get_name(),
            values=[KeyValue(key=key, value=value) for key, value in values.items()],
        )
        message = DiagnosticArray(status=[status])
        message.header.stamp = self._node.get_clock().now().to_msg()
        self._publisher.publish(message)
