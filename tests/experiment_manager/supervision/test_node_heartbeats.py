"""Signs of life of nodes, and those that give none."""

from collections.abc import Iterator
from contextlib import contextmanager

from rclpy.node import Node

from experiment_manager.supervision import node_heartbeats
from experiment_manager.supervision.node_heartbeats import Heartbeats
from lockstep.node.diagnostics import Diagnostics
from tests.node_harness import Graph


@contextmanager
def _heard(graph: Graph) -> Iterator[Heartbeats]:
    """Yield heartbeats that wait for eye_plant and sparse_coder, and have heard the first."""
    node = graph.add(lambda **kwargs: Node("eye_plant", **kwargs))
    Diagnostics(node)
    with Heartbeats(graph.domain, ["eye_plant", "sparse_coder"]) as listening:
        graph.spin_until(lambda: listening.wait(0.01) or listening.heard, "a sign of life")
        assert listening.heard == {"eye_plant"}
        yield listening


def test_who_is_heard_is_known(graph: Graph) -> None:
    with _heard(graph) as listening:
        assert listening.wait(0.0) is None


def test_a_node_that_falls_silent(graph, monkeypatch) -> None:
    monkeypatch.setattr(node_heartbeats, "SILENCE_LIMIT_S", -1.0)
    with _heard(graph) as listening:
        assert listening.wait(0.0) == "eye_plant does not respond"


def test_a_node_that_never_says_anything(graph, monkeypatch) -> None:
    monkeypatch.setattr(node_heartbeats, "START_LIMIT_S", -1.0)
    with Heartbeats(graph.domain, ["sparse_coder"]) as listening:
        assert listening.wait(0.0) == "sparse_coder does not respond"
