"""Nodes under test: each in a ROS context and a domain of its own, spun until something happens."""

import contextlib
import os
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any
from unittest import mock

from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.srv import SetParametersAtomically
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import HistoryPolicy, QoSProfile

from experiment_manager.supervision.domains import own_domain
from lockstep.node.diagnostics import Diagnostics
from lockstep.node.requests import service_name
from tests.patience import PATIENCE_S
from tests.stamps import to_ns

_KEEP_ALL = QoSProfile(history=HistoryPolicy.KEEP_ALL, depth=0)


class Graph:
    """A ROS context in a domain of its own, with an executor that the test itself turns."""

    def __init__(self, domain: int) -> None:
        self.domain = domain
        self.context = Context()
        self.context.init(domain_id=domain)
        self._executor = SingleThreadedExecutor(context=self.context)
        self._nodes: list[Node] = []

    def add(self, make_node: Callable[..., Node], **parameters: Any) -> Any:
        """Make a node here, with parameters whose dots are written as two underscores."""
        overrides = [Parameter(k.replace("__", "."), value=v) for k, v in parameters.items()]
        node = make_node(context=self.context, parameter_overrides=overrides)
        self._nodes.append(node)
        self._executor.add_node(node)
        return node

    def remove(self, node: Node) -> None:
        """Take a node away again."""
        self._nodes.remove(node)
        self._executor.remove_node(node)
        node.destroy_node()

    def spin_until(self, condition: Callable[[], object], what: str) -> None:
        """Let the nodes work until the condition holds."""
        end_s = time.monotonic() + PATIENCE_S
        while not condition():
            assert time.monotonic() < end_s, f"waited {PATIENCE_S} s in vain for {what}"
            # A node may end it all: then the condition says whether it should have.
            with contextlib.suppress(ExternalShutdownException):
                self._executor.spin_once(timeout_sec=0.1)

    def close(self) -> None:
        """Leave the domain."""
        self._executor.shutdown()
        for node in self._nodes:
            node.destroy_node()
        self.context.try_shutdown()


@contextmanager
def ros_graph() -> Iterator[Graph]:
    """Yield a graph in a domain that nobody else uses."""
    with mock.patch.dict(os.environ):
        os.environ.pop("ROS_DOMAIN_ID", None)
        with own_domain() as domain:
            graph = Graph(domain)
            try:
                yield graph
            finally:
                graph.close()


class Outsider(Node):
    """The other end of the topics and requests of a node under test."""

    def __init__(
        self, publishes: Mapping[str, type], hears: Mapping[str, type], **kwargs: Any
    ) -> None:
        super().__init__("outsider", **kwargs)
        self.heard: dict[str, list[Any]] = {topic: [] for topic in hears}
        self._ends = {
            topic: self.create_publisher(kind, topic, _KEEP_ALL)
            for topic, kind in publishes.items()
        }
        for topic, kind in hears.items():
            self.create_subscription(kind, topic, self.heard[topic].append, _KEEP_ALL)
        self.status: dict[str, str] = {}
        self.status_of: dict[str, dict[str, str]] = {}  # by node
        self.n_statuses = 0
        self.create_subscription(DiagnosticArray, "/diagnostics", self._hear_status, _KEEP_ALL)
        self._clients_by_node: dict[str, Any] = {}

    def _hear_status(self, message: DiagnosticArray) -> None:
        for status in message.status:
            self.status = {entry.key: entry.value for entry in status.values}
            self.status_of[status.hardware_id] = self.status
            self.n_statuses += 1

    def is_matched(self) -> bool:
        """Whether each topic has somebody at its other end."""
        return all(end.get_subscription_count() for end in self._ends.values()) and all(
            self.count_publishers(topic) for topic in self.heard
        )

    def send(self, topic: str, message: Any) -> None:
        """Publish."""
        self._ends[topic].publish(message)

    def stamps_ns(self, topic: str) -> list[int]:
        """Return the stamps heard so far."""
        return [to_ns(message.header.stamp) for message in self.heard[topic]]

    def distinct(self, topic: str) -> list[Any]:
        """Return the first message of each stamp: a plant that waits repeats itself."""
        first: dict[int, Any] = {}
        for stamp_ns, message in zip(self.stamps_ns(topic), self.heard[topic], strict=True):
            first.setdefault(stamp_ns, message)
        return list(first.values())

    def client_of(self, node: str) -> Any:
        """Return the client of a node's request service."""
        if node not in self._clients_by_node:
            client = self.create_client(SetParametersAtomically, service_name(node))
            self._clients_by_node[node] = client
        return self._clients_by_node[node]

    def future_answer(self, node: str, values: Mapping[str, Any]) -> Any:
        """Send named values to a node's request service."""
        parameters = [Parameter(k, value=v).to_parameter_msg() for k, v in values.items()]
        request = SetParametersAtomically.Request(parameters=parameters)
        return self.client_of(node).call_async(request)

    def has_service(self, node: str) -> bool:
        """Whether a node answers requests by now."""
        return bool(self.client_of(node).service_is_ready())


class Bench:
    """A node under test and the outsider, matched, with a run started."""

    RUN = "run_of_this_test"

    def __init__(
        self, graph: Graph, node: Any, publishes: Mapping[str, type], hears: Mapping[str, type]
    ) -> None:
        self.graph = graph
        self.node = node
        self.name = node.get_name()
        self.outsider: Outsider = graph.add(lambda **kwargs: Outsider(publishes, hears, **kwargs))
        graph.spin_until(self.outsider.is_matched, "the topics to match")
        graph.spin_until(lambda: self.outsider.has_service(self.name), "the request service")

    def request(self, kind: str, run_id: str = RUN, **arguments: Any) -> tuple[bool, str]:
        """Ask the node; return whether it did it, and the reason why not."""
        return self.request_raw({"run_id": run_id, "request": kind} | arguments)

    def request_raw(self, values: Mapping[str, Any]) -> tuple[bool, str]:
        """Ask with any named values."""
        future = self.outsider.future_answer(self.name, values)
        self.graph.spin_until(future.done, f"the answer to {values}")
        result = future.result().result
        return result.successful, result.reason

    def wait_heard(self, topic: str, n_messages: int) -> list[Any]:
        """Wait for the first n messages of a topic; return all heard so far."""
        heard = self.outsider.heard[topic]
        self.graph.spin_until(lambda: len(heard) >= n_messages, f"{n_messages} of {topic}")
        return heard

    def wait_distinct(self, topic: str, n_stamps: int) -> list[Any]:
        """Wait for n different stamps of a topic; return the first message of each."""
        self.graph.spin_until(
            lambda: len(self.outsider.distinct(topic)) >= n_stamps, f"{n_stamps} stamps of {topic}"
        )
        return self.outsider.distinct(topic)

    def next_status(self) -> dict[str, str]:
        """Return what the node says on /diagnostics after this moment, by key."""
        n_statuses = self.outsider.n_statuses
        # The one under way may have been published before what the test has just seen.
        self.graph.spin_until(
            lambda: self.outsider.n_statuses >= n_statuses + 2, "two more on /diagnostics"
        )
        return self.outsider.status

    def wait_refused(self, n_refused: int) -> str:
        """Wait until the node has counted n refused inputs; return the last one's reason."""
        diagnostics: Diagnostics = self.node.diagnostics
        self.graph.spin_until(
            lambda: diagnostics.n_refused >= n_refused, f"{n_refused} refused inputs"
        )
        assert diagnostics.n_refused == n_refused
        return diagnostics.last_refused
