"""Diagnostics: what a node says of itself, and how little a flood of bad input can log."""

from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.node import Node

from lockstep.node.diagnostics import Diagnostics
from tests.node_harness import Graph


def test_counts_refusals_and_more_are_published_each_second(graph: Graph) -> None:
    node = graph.add(lambda **kwargs: Node("speaker", **kwargs))
    diagnostics = Diagnostics(node, lambda: {"mood": "fine"})
    listener = graph.add(Listener)
    graph.spin_until(lambda: listener.statuses, "a first status")
    first = listener.statuses[-1]
    assert first.name == "/speaker"
    assert first.hardware_id == "speaker"
    assert first.level == DiagnosticStatus.OK
    assert listener.values()["refused_inputs"] == "0"
    assert listener.values()["mood"] == "fine"
    for _ in range(3):
        diagnostics.count()
    diagnostics.refuse("first")
    diagnostics.refuse("second")
    graph.spin_until(
        lambda: listener.values()["refused_inputs"] == "2", "a status with both refusals"
    )
    last = listener.statuses[-1]
    assert last.level == DiagnosticStatus.WARN
    assert last.message == "inputs were refused"
    assert listener.values()["last_refused"] == "second"
    assert listener.values()["observations"] == "3"


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


class Listener(Node):
    """Keeps what it hears on /diagnostics."""

    def __init__(self, **kwargs: object) -> None:
        from diagnostic_msgs.msg import DiagnosticArray

        super().__init__("listener", **kwargs)
        self.statuses: list[DiagnosticStatus] = []
        self.create_subscription(
            DiagnosticArray, "/diagnostics", lambda m: self.statuses.extend(m.status), 10
        )

    def values(self) -> dict[str, str]:
        """Return the key-values of the last status."""
        return {entry.key: entry.value for entry in self.statuses[-1].values}
