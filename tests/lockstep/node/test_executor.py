"""The executor goes on when a request cannot be understood, whichever way it came upon it."""

import threading
from functools import partial
from typing import Any

import pytest
from rcl_interfaces.msg import Parameter, ParameterValue
from rcl_interfaces.srv import SetParameters
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.subscription import Subscription
from sensor_msgs.msg import JointState

from lockstep.node.executor import LockstepExecutor
from lockstep.wire.qos import LOCKSTEP_QOS
from tests.node_harness import Graph
from tests.patience import PATIENCE_S


@pytest.mark.parametrize("way", ["spin", "spin_once"])
def test_parameters_of_no_known_type_end_nobody(graph: Graph, way: str) -> None:
    node = Node("servant", context=graph.context)
    executor = LockstepExecutor(context=graph.context)
    executor.add_node(node)
    errors: list[BaseException] = []
    stop = threading.Event()
    # As in a process, whoever works on the node also ends it.
    node.create_timer(0.05, lambda: stop.is_set() and graph.context.try_shutdown())

    def work() -> None:
        try:
            if way == "spin":
                executor.spin()
            while graph.context.ok():
                executor.spin_once(timeout_sec=0.1)
        except ExternalShutdownException:
            pass
        except BaseException as error:
            errors.append(error)

    asker = graph.add(lambda **kwargs: Node("asker", **kwargs))
    client = asker.create_client(SetParameters, "servant/set_parameters")
    graph.spin_until(client.service_is_ready, "the service")
    worker = threading.Thread(target=work)
    worker.start()
    bad = SetParameters.Request(parameters=[Parameter(name="x", value=ParameterValue(type=250))])
    for _ in range(20):
        client.call_async(bad)
    good = client.call_async(SetParameters.Request(parameters=[]))
    graph.spin_until(lambda: good.done() or errors, "the answer to a request with sense")
    stop.set()
    worker.join(PATIENCE_S)
    node.destroy_node()
    assert errors == []
    assert good.result().results == []


class _Listener(Node):
    """Waits for b alone, until it has come; ends its context when it has heard a, b and c."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("listener", **kwargs)
        self.heard: list[str] = []
        self._topics = {
            topic: self.create_subscription(JointState, topic, partial(self._hear, topic), 10)
            for topic in ("a", "b", "c")
        }

    def awaited_subscriptions(self) -> list[Subscription]:
        return [*self._topics.values()] if "b" in self.heard else [self._topics["b"]]

    def _hear(self, topic: str, message: JointState) -> None:
        self.heard.append(topic)
        if {*self.heard} == {*self._topics}:
            self.context.try_shutdown()


def test_messages_not_waited_for_are_taken_with_those_that_are(graph: Graph) -> None:
    sender = graph.add(lambda **kwargs: Node("sender", **kwargs))
    publishers = {t: sender.create_publisher(JointState, t, LOCKSTEP_QOS) for t in ("a", "b", "c")}
    context = Context()
    context.init(domain_id=graph.domain)
    listener = _Listener(context=context)
    executor = LockstepExecutor(context=context)
    executor.add_node(listener)
    graph.spin_until(
        lambda: (
            all(p.get_subscription_count() for p in publishers.values())
            and all(listener.count_publishers(topic) for topic in publishers)
        ),
        "the listener",
    )
    worker = threading.Thread(target=executor.spin)
    worker.start()
    publishers["a"].publish(JointState())
    publishers["b"].publish(JointState())
    graph.spin_until(lambda: "b" in listener.heard, "what is waited for")
    publishers["c"].publish(JointState())
    worker.join(PATIENCE_S)
    listener.destroy_node()
    assert sorted(listener.heard) == ["a", "b", "c"]
