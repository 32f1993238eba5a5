"""Other graphs in the domain that a run is to use."""

from pathlib import Path
from unittest import mock

import pytest
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from sensor_msgs.msg import JointState

from active_binocular_vision.commands.run import main
from experiment_manager.supervision import node_neighbours
from experiment_manager.supervision.domains import NODE_SCRIPTS_DOMAIN, own_domain
from experiment_manager.supervision.node_neighbours import check_ros, refuse_neighbours
from experiment_manager.supervision.supervisor import known_domain
from lockstep import InputError
from lockstep.wire.qos import LOCKSTEP_QOS
from tests.node_harness import Graph


def _publishes(topic: str) -> type[Node]:
    class Somebody(Node):
        def __init__(self, **kwargs: object) -> None:
            super().__init__("somebody", **kwargs)
            self.create_publisher(JointState, topic, LOCKSTEP_QOS)
            # Who only listens may be there: what is refused names nothing of this.
            self.create_subscription(JointState, "ground_truth", print, LOCKSTEP_QOS)

    return Somebody


def test_a_domain_with_another_graph_is_refused(graph, monkeypatch) -> None:
    graph.add(_publishes("reward"))
    with pytest.raises(
        InputError,
        match=f"ROS domain {graph.domain}: expected no other graph in it, found somebody "
        "publishing reward; choose another ROS_DOMAIN_ID, or unset it",
    ):
        refuse_neighbours(graph.domain)
    # It may be there when it is the one that is started elsewhere.
    monkeypatch.setattr(node_neighbours, "_LISTEN_S", 0.5)
    refuse_neighbours(graph.domain, ["sparse_coder"])


def test_a_run_is_refused_before_anything_is_written(graph, monkeypatch, capsys, tmp_path) -> None:
    graph.add(_publishes("muscle_command"))
    monkeypatch.setenv("ROS_DOMAIN_ID", str(graph.domain))
    out = tmp_path / "run"
    assert main(["--out", str(out)]) == 2
    assert not out.exists()
    (error,) = capsys.readouterr().err.splitlines()
    assert error.startswith(f"error: ROS domain {graph.domain}: expected no other graph in it, ")


@pytest.mark.parametrize(
    "variable",
    [
        "ROS_AUTOMATIC_DISCOVERY_RANGE=OFF",
        "ROS_LOG_DIR=/proc/logs",
        "ROS_DOMAIN_ID=\N{SUPERSCRIPT TWO}",
        "ROS_DOMAIN_ID=010",
    ],
)
def test_an_environment_without_a_graph_is_named(monkeypatch, capsys, tmp_path, variable) -> None:
    name, _, value = variable.partition("=")
    monkeypatch.setenv(name, value)
    assert main(["--out", str(tmp_path / "run")]) == 2
    assert not (tmp_path / "run").exists()
    (error,) = capsys.readouterr().err.splitlines()
    assert error.startswith(f"error: {name}: expected ")
    assert value in error


@pytest.mark.parametrize(
    ("raised", "why"), [(None, "they do not find each other"), ("rcl\nfailed", "rcl failed")]
)
def test_nodes_of_an_unusual_network_are_tried_first(monkeypatch, raised, why) -> None:
    """As with a profile of a discovery client, and with keys that are not of our nodes."""

    class Alone:
        node = mock.Mock(get_node_names=lambda: ["supervisor"])
        close = mock.Mock()

        def __init__(self, domain: int) -> None:
            if raised:
                raise rclpy_implementation.RCLError(raised)

    monkeypatch.setattr(node_neighbours, "Observer", Alone)
    monkeypatch.setattr(node_neighbours, "_MEET_S", 0.2)
    check_ros(None)
    monkeypatch.setenv("FASTRTPS_DEFAULT_PROFILES_FILE", "mine.xml")
    check_ros(None, ["eye_plant"])
    message = f"expected two nodes to meet here, but {why}, with FASTRTPS.*=mine.xml, "
    with pytest.raises(InputError, match=message):
        check_ros(None)


def test_only_a_domain_that_others_can_be_in_is_listened_to(monkeypatch) -> None:
    looked: list[int] = []
    monkeypatch.setattr(node_neighbours, "_publishers", lambda domain, _: looked.append(domain))
    with own_domain() as domain:
        refuse_neighbours(domain)
        assert looked == []
        monkeypatch.setattr(node_neighbours, "reaches_other_machines", lambda _: True)
        refuse_neighbours(domain)
        assert looked == [domain]


def test_the_domain_of_nodes_elsewhere_is_known(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("ROS_DOMAIN_ID", raising=False)
    assert known_domain(()) is None
    assert known_domain(["eye_plant"]) == NODE_SCRIPTS_DOMAIN
    monkeypatch.setenv("ROS_DOMAIN_ID", "17")
    assert known_domain(()) == known_domain(["eye_plant"]) == 17


@pytest.mark.parametrize("text", ["-1", "233", "abc", "1.5", " 3"])
def test_what_is_no_domain_is_refused(monkeypatch: pytest.MonkeyPatch, text: str) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", text)
    with pytest.raises(InputError, match="ROS_DOMAIN_ID: expected a whole number 0 to 232, got"):
        known_domain(())


def test_nodes_leave_nothing_in_shared_memory(graph: Graph) -> None:
    graph.add(_publishes("reward"))
    mapped = Path("/proc/self/maps").read_text()
    assert "rmw_fastrtps" in mapped
    assert "/dev/shm/fastrtps" not in mapped
