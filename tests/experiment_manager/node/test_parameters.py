"""Asking nodes for their parameters while they are still starting."""

from types import SimpleNamespace
from typing import Any

from rcl_interfaces.srv import GetParameters, ListParameters
from rclpy.parameter import Parameter

from experiment_manager.node.parameters import NodeParameters, Parameters
from experiment_manager.node.presence import UNKNOWN_NODE
from experiment_manager.run.recorded_topics import SMALL_TOPICS


class Client:
    """A service that is ready, and answers, when a test says so."""

    def __init__(self, service: str) -> None:
        self.service = service
        self.is_ready = False
        self.requests: list[Any] = []
        self._tell: Any = None

    def service_is_ready(self) -> bool:
        return self.is_ready

    def call_async(self, request: Any) -> "Client":
        self.requests.append(request)
        return self

    def add_done_callback(self, tell: Any) -> None:
        self._tell = tell

    def answer(self, response: Any) -> None:
        self._tell(SimpleNamespace(result=lambda: response))


class Node:
    """A graph of one other node, whose name is not known yet."""

    def __init__(self) -> None:
        self.name = UNKNOWN_NODE
        self.clients: list[Client] = []

    def get_fully_qualified_name(self) -> str:
        return "/experiment_manager"

    def get_publishers_info_by_topic(self, topic: str) -> list[Any]:
        return [SimpleNamespace(node_namespace="/", node_name=self.name)]

    def create_client(self, kind: Any, service: str) -> Client:
        self.clients.append(Client(service))
        return self.clients[-1]

    def destroy_client(self, client: Client) -> None:
        self.clients.remove(client)


def test_a_node_is_asked_when_its_name_is_known_and_its_service_is_there() -> None:
    node = Node()
    found: list[Parameters] = []
    parameters = NodeParameters(node, SMALL_TOPICS, lambda act: act())
    parameters.ask(found.append)
    parameters.watch()
    assert not node.clients, "nobody has a name to be asked by"
    node.name = "eye_plant"
    parameters.watch()
    (client,) = node.clients
    assert client.service == "/eye_plant/list_parameters"
    parameters.watch()
    assert not client.requests, "a request would be lost"
    client.is_ready = True
    parameters.watch()
    parameters.watch()
    assert len(client.requests) == 1
    listed = ListParameters.Response()
    listed.result.names = ["seed"]
    client.answer(listed)
    (client,) = node.clients
    assert client.service == "/eye_plant/get_parameters"
    client.is_ready = True
    parameters.watch()
    assert client.requests == [GetParameters.Request(names=["seed"])]
    assert not found
    client.answer(GetParameters.Response(values=[Parameter("seed", value=3).get_parameter_value()]))
    assert found == [{"eye_plant": {"seed": 3}}]
    assert not node.clients
