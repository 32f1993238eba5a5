"""Which node of a run has gone silent, from what they say on /diagnostics each second."""

import time
from collections.abc import Sequence
from contextlib import AbstractContextManager

from diagnostic_msgs.msg import DiagnosticArray

from experiment_manager.nodes import NODES
from experiment_manager.supervision.node_neighbours import Observer
from lockstep.node.diagnostics import TOPIC

START_LIMIT_S = 120.0
SILENCE_LIMIT_S = 10.0


class Heartbeats(AbstractContextManager["Heartbeats"]):
    """Listens in one domain while the block lasts.

    heard: the names of all who have said something.
    """

    def __init__(self, domain: int, packages: Sequence[str] = NODES) -> None:
        """Begin to listen to these nodes; each has START_LIMIT_S to say something."""
        self._observer = Observer(domain)
        self._observer.node.create_subscription(DiagnosticArray, TOPIC, self._hear, 10)
        self.heard: set[str] = set()
        self._deadline_s = dict.fromkeys(packages, time.monotonic() + START_LIMIT_S)

    def __exit__(self, *exception: object) -> None:
        """Leave the domain."""
        self._observer.close()

    def wait(self, timeout_s: float = 0.2) -> str | None:
        """Listen for a moment; return the fault of a node that has been silent for too long."""
        self._observer.executor.spin_once(timeout_sec=timeout_s)
        now_s = time.monotonic()
        silent = [name for name, end_s in self._deadline_s.items() if now_s > end_s]
        return f"{silent[0]} does not respond" if silent else None

    def _hear(self, message: DiagnosticArray) -> None:
        for status in message.status:
            name = status.hardware_id
            self.heard.add(name)
            if name in self._deadline_s:
                self._deadline_s[name] = time.monotonic() + SILENCE_LIMIT_S
