"""Which node of a run has gone silent, from what they say on /diagnostics each second."""

import time
from collections.abc import Sequence

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from experiment_manager.supervision.processes import PACKAGES
from lockstep.node.diagnostics import TOPIC

START_LIMIT_S = 120.0
SILENCE_LIMIT_S = 10.0


class Heartbeats:
    """Listens in one domain, with a ROS context of its own, while the block lasts.

    heard: the names of all who have said something.
    """

    def __init__(self, domain: int, packages: Sequence[str] = PACKAGES) -> None:
        """Begin to listen to these nodes; each has START_LIMIT_S to say something."""
        self._context = Context()
        self._context.init(domain_id=domain)
        self._node = Node("supervisor", context=self._context, start_parameter_services=False)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._node.create_subscription(DiagnosticArray, TOPIC, self._hear, 10)
        self.heard: set[str] = set()
        self._deadline_s = dict.fromkeys(packages, time.monotonic() + START_LIMIT_S)

    def __enter__(self) -> "Heartbeats":
        """Return itself."""
        return self

    def __exit__(self, *exception: object) -> None:
        """Leave the domain."""
        self._executor.shutdown()
        self._node.destroy_node()
        self._context.try_shutdown()

    def _hear(self, message: DiagnosticArray) -> None:
        for status in message.status:
            self.heard.add(status.hardware_id)
            if status.hardware_id in self._deadline_s:
                self._deadline_s[status.hardware_id] = time.monotonic() + SILENCE_LIMIT_S

    def wait(self, timeout_s: float = 0.2) -> str | None:
        """Listen for a moment; return the name of a node that has been silent for too long."""
        self._executor.spin_once(timeout_sec=timeout_s)
        now_s = time.monotonic()
        return next((name for name, end_s in self._deadline_s.items() if now_s > end_s), None)
