"""Diagnostics: what a node says of itself, and how little a flood of bad input can log."""

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.node import Node

from lockstep.node.diagnostics import TOPIC, Diagnostics
from tests.node_harness import Graph, Outsider


def values_of(message: DiagnosticArray) -> dict[str, str]:
    """Return the key-values of the one status of a message."""
    (status,) = message.status
    return {entry.key: entry.value for entry in status.values}


def test_counts_refusals_and_more_are_published_each_second(graph: Graph) -> None:
    node = graph.add(lambda **kwargs: Node("speaker", **kwargs))
    diagnostics = Diagnostics(node, lambda: {"mood": "fine"})
    listener = graph.add(lambda **kwargs: Outsider({}, {TOPIC: DiagnosticArray}, **kwargs))
    heard = listener.heard[TOPIC]
    graph.spin_until(lambda: heard, "a first status")
    first = heard[-1].status[0]
    assert first.name == "/speaker"
    assert first.hardware_id == "speaker"
    assert first.level == DiagnosticStatus.OK
    assert values_of(heard[-1])["refused_inputs"] == "0"
    assert values_of(heard[-1])["mood"] == "fine"
    for _ in range(3):
        diagnostics.count()
    diagnostics.refuse("first")
    diagnostics.refuse("second")
    graph.spin_until(
        lambda: values_of(heard[-1])["refused_inputs"] == "2", "a status with both refusals"
    )
    last = heard[-1].status[0]
    assert last.level == DiagnosticStatus.WARN
    assert last.message == "inputs were refused"
    assert values_of(heard[-1])["last_refused"] == "second"
    assert values_of(heard[-1])["observations"] == "3"


def test_a_flood_of_refusals_is_a_trickle_of_log_lines(graph, capfd) -> None:
    node = graph.add(lambda **kwargs: Node("flooded", **kwargs))
    diagnostics = Diagnostics(node)
    for i in range(5000):
        diagnostics.refuse(f"number {i}")
    assert diagnostics.n_refused == 5000
    lines = [line for line in capfd.readouterr().err.splitlines() if "refused: number" in line]
    # One a second, however slow the machine: 5000 refusals take far less than a minute.
    assert 1 <= len(lines) < 60
    assert "refused: number 0" in lines[0]
