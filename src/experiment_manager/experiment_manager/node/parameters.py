"""With which parameters the nodes of the graph run: each is asked, with ROS's own services."""

import time
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

from rcl_interfaces.srv import GetParameters, ListParameters
from rclpy.client import Client
from rclpy.node import Node
from rclpy.parameter import parameter_value_to_python

from experiment_manager.node.presence import UNKNOWN_NODE
from lockstep.node.ros_parameters import OF_RCLPY

# A node without parameter services, as some clients of DDS are, is not waited for any longer.
_PATIENCE_S = 5.0
# One that has them may be busy starting.
_PATIENCE_WITH_SERVICES_S = 60.0

Parameters = dict[str, dict[str, Any]]


class NodeParameters:
    """Asks whoever publishes a topic of the graph for all of its parameters."""

    def __init__(
        self, node: Node, topics: Sequence[str], guard: Callable[[Callable[[], None]], None]
    ) -> None:
        """topics: of the graph; guard: calls what follows the last answer."""
        self._node, self._topics = node, topics
        self._guard = guard
        self._clients: dict[str, Client] = {}
        # What is asked as soon as the service is there: a request before that would be lost.
        self._unsent: dict[str, Callable[[], None]] = {}
        self._found: Parameters = {}
        self._then: Callable[[Parameters], None] | None = None
        self._asked_s = 0.0
        self._has_begun = False

    def ask(self, then: Callable[[Parameters], None]) -> None:
        """Ask all; then go on with what they answered, by node and by name."""
        self._then = then
        self._asked_s = time.monotonic()
        self._begin()

    def _begin(self) -> None:
        """Ask all, once their names are known."""
        publishers = self._publishers()
        if UNKNOWN_NODE in publishers and time.monotonic() - self._asked_s < _PATIENCE_S:
            return
        self._has_begun, self._asked_s = True, time.monotonic()
        for name, full_name in publishers.items():
            client = self._node.create_client(ListParameters, f"{full_name}/list_parameters")
            answered = partial(self._get, name, full_name)
            self._call(name, client, ListParameters.Request(), answered)
        self._go_on()

    def watch(self) -> None:
        """Ask those whose service has come up; go on without those that have not answered in time.

        To be called now and then.
        """
        if self._then is None:
            return
        if not self._has_begun:
            self._begin()
            return
        waited_s = time.monotonic() - self._asked_s
        for name in [*self._clients]:
            self._send_if_ready(name)
            if waited_s < (_PATIENCE_S if name in self._unsent else _PATIENCE_WITH_SERVICES_S):
                continue
            self._node.get_logger().warning(
                f"{name} does not report its parameters: config.yaml and bag will lack them"
            )
            self._end(name)
        self._go_on()

    def _publishers(self) -> Mapping[str, str]:
        """Return name and full name of each node, except this one, that publishes a topic."""
        own = self._node.get_fully_qualified_name()
        found = {}
        for topic in self._topics:
            for endpoint in self._node.get_publishers_info_by_topic(topic):
                full_name = f"{endpoint.node_namespace.rstrip('/')}/{endpoint.node_name}"
                if full_name != own:
                    found[endpoint.node_name] = full_name
        return found

    def _call(self, name: str, client: Client, request: Any, then: Callable[[Any], None]) -> None:
        def on_answer(future: Any) -> None:
            if future.result() is not None:
                self._guard(partial(then, future.result()))

        def send() -> None:
            client.call_async(request).add_done_callback(on_answer)

        self._clients[name], self._unsent[name] = client, send
        self._send_if_ready(name)

    def _send_if_ready(self, name: str) -> None:
        if name in self._unsent and self._clients[name].service_is_ready():
            self._unsent.pop(name)()

    def _get(self, name: str, full_name: str, listed: ListParameters.Response) -> None:
        if name not in self._clients:
            return
        names = [n for n in listed.result.names if not n.startswith(OF_RCLPY)]
        self._end(name)
        client = self._node.create_client(GetParameters, f"{full_name}/get_parameters")
        answered = partial(self._take, name, names)
        self._call(name, client, GetParameters.Request(names=names), answered)

    def _take(self, name: str, names: list[str], got: GetParameters.Response) -> None:
        if name not in self._clients:
            return
        values = [parameter_value_to_python(value) for value in got.values]
        self._found[name] = {
            n: list(v) if hasattr(v, "__iter__") and not isinstance(v, str) else v
            for n, v in zip(names, values, strict=True)
        }
        self._end(name)
        self._go_on()

    def _end(self, name: str) -> None:
        self._unsent.pop(name, None)
        self._node.destroy_client(self._clients.pop(name))

    def _go_on(self) -> None:
        if not self._clients and self._then is not None:
            then, self._then = self._then, None
            then(self._found)
