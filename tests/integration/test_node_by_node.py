"""Nodes started one by one, in any order, and one of them somebody else's."""

import json
from pathlib import Path
from typing import Any

import pytest
from rclpy.node import Node
from sensor_msgs.msg import Image, JointState

from active_binocular_vision import Run
from active_binocular_vision.commands.evaluate import main as evaluate
from experiment_manager import read_configuration
from lockstep.wire.qos import LOCKSTEP_QOS
from lockstep.wire.topics import LEARNER_VECTORS
from lockstep.wire.vectors import VectorPublisher, vector_message
from tests.graph_harness import vectors
from tests.loop_contract import assert_as_the_loop
from tests.node_harness import Graph
from tests.pair import ACTOR_CRITIC_NAMES
from tests.supervisor import finished, start_supervisor

pytestmark = pytest.mark.graph

# Of the fixture config_file.
N_TRAINING = 20


def _in_run(directory: Path) -> tuple[str, str]:
    return "-p", f"run_directory:={directory}"


def test_any_order_a_late_learner_and_another_plant_give_the_same_numbers(
    graph: Graph, start_node, tmp_path, config_file
) -> None:
    run = tmp_path / "run"
    manager = start_node("experiment_manager", *_in_run(run), "-p", "gap_s:=0.5")
    manager.wait_for_line("waiting for episode, ")
    start_node("vergence_rl").wait_for_line("ready, untrained")
    plant = start_node("eye_plant")
    plant.wait_for_line("5 stimuli resident")
    # The coder joins when all others have been waiting for it.
    manager.wait_for_line("waiting for reward")
    start_node("sparse_coder")
    # The plant is started again in an early episode.
    first = run / "checkpoints" / "000000000" / "manifest.json"
    graph.spin_until(first.exists, "the first episode")
    plant.process.terminate()
    start_node("eye_plant")
    manager.wait_for_line("eye_plant was started again: rolling back to the newest checkpoint")
    manager.finished()
    assert_as_the_loop(run)
    # All parameters of all nodes are written down.
    expected = read_configuration(config_file)
    expected["experiment_manager"] |= {"run_directory": str(run), "gap_s": 0.5}
    assert read_configuration(run / "config.yaml") == expected
    assert Run(run).configuration_text == (run / "config.yaml").read_text()
    assert evaluate([str(run)]) == 0


class Scripted(Node):
    """A vergence_rl of somebody else's: it knows the topics, and nothing of our requests."""

    def __init__(self, **kwargs: Any) -> None:
        super().__init__("my_own_controller", **kwargs)
        self._thought = VectorPublisher(self, "actor_critic", ACTOR_CRITIC_NAMES)
        self._command = self.create_publisher(JointState, "muscle_command", LOCKSTEP_QOS)
        self.create_subscription(Image, "features", self._answer, LOCKSTEP_QOS)

    def _answer(self, features: Image) -> None:
        stamp_ns = features.header.stamp.sec * 10**9 + features.header.stamp.nanosec
        self._thought.publish(stamp_ns, (0.0,) * len(ACTOR_CRITIC_NAMES))
        names = ("left_medial_rectus", "right_medial_rectus", "lateral_rectus")
        self._command.publish(vector_message(stamp_ns, names, (0.06, 0.04, 0.01)))


def test_a_foreign_node_needs_only_its_topics(graph: Graph, start_node, tmp_path: Path) -> None:
    run = tmp_path / "run"
    graph.add(Scripted)
    for package in ("eye_plant", "sparse_coder"):
        start_node(package)
    manager = start_node("experiment_manager", *_in_run(run))
    graph.spin_until(lambda: manager.process.poll() is not None, "the end of the run")
    output = manager.finished()
    assert "vergence_rl answers no requests: the run continues without checkpoints" in output
    assert not list((run / "checkpoints").glob("*/manifest.json"))
    results = json.loads((run / "results.json").read_text())
    assert [test["n_trials"] for test in results["tests"]] == [4, 4]
    tables = vectors(run)
    n_answered = N_TRAINING + 2 * 4 * 20
    for topic in LEARNER_VECTORS:
        assert len(tables[topic].stamps_ns) == n_answered
    activations = tables["muscle_activations"]
    after_first = tables["episode"].column("iteration") > 0
    assert set(activations.column("left_medial_rectus")[after_first]) == {0.06}
    assert set(activations.column("right_medial_rectus")[after_first]) == {0.04}
    # Of ten episodes and trials; a picture that comes after the last has a file of its own.
    assert len(list((run / "bag").glob("*.mcap"))) <= 2
    assert evaluate([str(run)]) == 0
    # Without a checkpoint there is nothing to go on from; what was recorded stays.
    (run / "config.yaml").write_bytes((tmp_path / "config.yaml").read_bytes())
    assert "error: " in finished(start_supervisor(["--resume", str(run)]), code=2)
    assert vectors(run)["ground_truth"].stamps_ns.tolist() == (
        tables["ground_truth"].stamps_ns.tolist()
    )


def test_nodes_that_contradict_each_other_or_how_the_run_began_do_not_start(
    start_node, tmp_path, config_file
) -> None:
    start_node("vergence_rl", "-p", "cacla.discount:=0.4")
    for name in ("eye_plant", "sparse_coder"):
        start_node(name)
    begun, new = tmp_path / "begun", tmp_path / "new"
    begun.mkdir()
    (begun / "config.yaml").write_bytes(config_file.read_bytes())
    output = start_node("experiment_manager", *_in_run(begun)).finished(code=2)
    assert "vergence_rl.cacla.discount was 0.3, is 0.4" in output.splitlines()[-1]
    # The nodes are still there, for another manager, whose eyes are farther apart.
    farther = "-p", "mechanics.baseline_m:=0.06"
    output = start_node("experiment_manager", *_in_run(new), *farther).finished(code=2)
    message = "expected mechanics.baseline_m 0.06, as experiment_manager has it, got 0.056"
    assert message in output.splitlines()[-1]
    assert not new.exists()


def test_bad_input_of_any_kind_stops_each_node_with_one_line(start_node) -> None:
    """What each node refuses is tested with it; here, that its script ends as it should."""
    cases = [
        ("eye_plant", ("-p", "camera.width_px:=wide"), "camera.width_px: expected an integer, "),
        ("sparse_coder", ("--", "--foo", "bar"), "unknown argument --foo bar: expected"),
        ("vergence_rl", ("-p", "SOME:=[a, 1.5"), "expected ROS arguments: "),
        ("experiment_manager", ("-p", "colour:=red"), "unknown parameter colour: expected some"),
    ]
    nodes = [start_node(package, *arguments) for package, arguments, _ in cases]
    for node, (*_, message) in zip(nodes, cases, strict=True):
        output = node.finished(code=2)
        assert output.splitlines()[-1].startswith(f"error: {message}")
        assert "Traceback" not in output
