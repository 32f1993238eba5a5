"""The executor goes on when a request cannot be understood, whichever way it came upon it."""

import threading
from collections.abc import Iterator

import pytest
from rcl_interfaces.msg import Parameter, ParameterValue
from rcl_interfaces.srv import SetParameters
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node

from lockstep.executor import LockstepExecutor
from tests.node_harness import Graph, ros_graph


@pytest.fixture
def graph() -> Iterator[Graph]:
    """Yield a domain of the test's own."""
    with ros_graph() as graph:
        yield graph


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
    worker.join()
    node.destroy_node()
    assert errors == []
    assert good.result().results == []
