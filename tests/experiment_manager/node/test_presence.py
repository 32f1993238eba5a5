"""Which topics have more than one publisher, as a graph shows it that counts the dead as well."""

from types import SimpleNamespace
from typing import Any

import pytest

from experiment_manager.node import presence
from experiment_manager.node.presence import LEASE_S, UNKNOWN_NODE, Presence


class Graph:
    """The names of the nodes that publish the topic reward."""

    def __init__(self) -> None:
        self.names = ["sparse_coder"]

    def count_publishers(self, topic: str) -> int:
        return len(self.names)

    def get_publishers_info_by_topic(self, topic: str) -> list[Any]:
        return [SimpleNamespace(node_name=name, node_namespace="/") for name in self.names]


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    clock = SimpleNamespace(now_s=100.0)
    monkeypatch.setattr(presence.time, "monotonic", lambda: clock.now_s)
    return clock


def seen(graph: Graph) -> Presence:
    node: Any = graph
    return Presence(node, ["reward"])


def test_a_second_node_of_the_same_name_is_in_doubt_for_the_lease(clock: SimpleNamespace) -> None:
    graph = Graph()
    found = seen(graph)
    assert found.doubled_topics() == ([], [])
    graph.names = ["sparse_coder"] * 2
    assert found.doubled_topics() == ([], ["reward"])
    clock.now_s += LEASE_S - 1.0
    graph.names = ["sparse_coder"] * 3  # killed and started once more
    assert found.doubled_topics() == ([], ["reward"])
    clock.now_s += LEASE_S - 1.0
    assert found.doubled_topics() == ([], ["reward"])
    clock.now_s += 2.0
    assert found.doubled_topics() == (["reward"], [])
    graph.names = ["sparse_coder"]
    assert found.doubled_topics() == ([], [])


def test_a_node_of_another_name_is_certain_once_its_name_is_known(clock: SimpleNamespace) -> None:
    graph = Graph()
    found = seen(graph)
    graph.names = ["sparse_coder", UNKNOWN_NODE]
    assert found.doubled_topics() == ([], ["reward"])
    graph.names = ["sparse_coder", "another"]
    assert found.doubled_topics() == (["reward"], [])
