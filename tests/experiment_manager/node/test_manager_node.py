"""The node experiment_manager, with a scripted plant and scripted learners around it."""

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Image, JointState

from experiment_manager import Bag
from experiment_manager.node import presence
from experiment_manager.node import requests as node_requests
from experiment_manager.node.manager_node import ExperimentManagerNode
from experiment_manager.run.recorded_topics import SMALL_TOPICS
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from lockstep import InputError
from lockstep.exit_codes import EXIT_FAULT, EXIT_INTERRUPTED, EXIT_ROLL_BACK, EXIT_UNWRITABLE
from lockstep.wire.qos import LOCKSTEP_QOS
from lockstep.wire.stamps import period_ns
from lockstep.wire.topics import PLANT_VECTORS, reward_names
from lockstep.wire.vectors import VectorPublisher
from tests.experiment_manager.scripted_graph import (
    PERIOD_NS,
    ScriptedCoder,
    ScriptedLearner,
    ScriptedPlant,
)
from tests.node_harness import Graph, ros_graph

SMALL: dict[str, Any] = {
    "n_training_iterations": 20,
    "test_iterations": [0],
    "test_distances_m": [6.0],
    "least_start_error_deg": 0,
    "n_stimuli_per_test": 1,
}
# A trial, two training episodes, the trial again.
N_OBSERVATIONS = 21 + 2 * 11 + 21
Start = Callable[..., ExperimentManagerNode]


@pytest.fixture
def nodes(graph: Graph) -> tuple[ScriptedPlant, ScriptedCoder, ScriptedLearner]:
    """Return the scripted nodes."""
    return graph.add(ScriptedPlant), graph.add(ScriptedCoder), graph.add(ScriptedLearner)


def _start(graph: Graph, directory: Path, **settings: Any) -> ExperimentManagerNode:
    manager: ExperimentManagerNode = graph.add(
        ExperimentManagerNode, run_directory=str(directory), **(SMALL | settings)
    )
    return manager


def _spin_until_said(graph: Graph, capfd: pytest.CaptureFixture[str], text: str) -> None:
    said = ""

    def has_said() -> bool:
        nonlocal said
        said += capfd.readouterr().err
        return text in said

    graph.spin_until(has_said, f"the manager to say {text!r}")


def _finished(graph: Graph, manager: ExperimentManagerNode) -> int:
    """Let the run end, which takes the context down with it; return the node's exit code."""
    graph.spin_until(lambda: not graph.context.ok(), "the end of the run")
    manager.destroy_node()
    return int(manager.exit_code)


def test_the_scripted_plant_keeps_the_managers_time() -> None:
    assert period_ns(MechanicsConfig().period_s) == PERIOD_NS


def test_a_run_from_its_first_request_to_its_results(graph, nodes, tmp_path) -> None:
    plant, coder, learner = nodes
    manager = _start(graph, tmp_path / "run")
    assert _finished(graph, manager) == 0
    assert plant.asked == ["start_run", *["episode"] * 4, "end_run"]
    # States are saved before the first episode and after the last one.
    assert coder.asked == learner.asked == ["start_run", "save", "save", "end_run"]
    assert [e.first_observation for e in plant.episodes] == [0, 21, 32, 43]
    assert [e.phase for e in plant.episodes] == [1, 0, 0, 1]
    tables = Bag(tmp_path / "run" / "bag").vectors(*SMALL_TOPICS)
    stamps_ns = np.arange(N_OBSERVATIONS) * PERIOD_NS
    assert tables["ground_truth"].stamps_ns.tolist() == stamps_ns.tolist()
    assert len(tables["muscle_command"].stamps_ns) == N_OBSERVATIONS - 4
    results = json.loads((tmp_path / "run" / "results.json").read_text())
    assert [test["n_trials"] for test in results["tests"]] == [1, 1]
    assert results["tests"][0]["median_abs_vergence_error_deg"] == 1.0


@pytest.mark.parametrize(
    "refusal", [(0, "start_run"), (0, "episode"), (1, "start_run"), (1, "save"), (2, "save")]
)
def test_a_refusal_ends_the_run_with_its_reason(graph, nodes, tmp_path, capfd, refusal) -> None:
    who, kind = refusal
    nodes[who].refuses = kind
    name = nodes[who].get_name()
    code = EXIT_UNWRITABLE if kind == "save" else EXIT_FAULT
    assert _finished(graph, _start(graph, tmp_path / "run")) == code
    assert f"the run cannot continue: {name} refused {kind}: expected another episode" in (
        capfd.readouterr().err
    )
    assert not (tmp_path / "run" / "results.json").exists()


def test_under_supervision_a_gap_is_a_fault(graph, nodes, tmp_path, capfd) -> None:
    nodes[1].is_mute = True
    manager = _start(graph, tmp_path / "run", supervised=True, gap_s=0.3)
    assert _finished(graph, manager) == EXIT_FAULT
    error = capfd.readouterr().err
    assert "the run cannot continue: no message for 0.3 s; missing: 20 of episode" in error
    assert "20 of reward" in error


def test_under_supervision_who_is_not_there_is_waited_for(graph, nodes, tmp_path, capfd) -> None:
    # Nobody whom the supervisor has started: it would know. So it is the network, or a person.
    _, coder, _ = nodes
    coder.is_mute = True
    manager = _start(graph, tmp_path / "run", supervised=True, gap_s=0.3)
    graph.spin_until(lambda: nodes[0].episodes, "the first episode")
    graph.remove(coder)
    _spin_until_said(graph, capfd, "waiting for reward")
    assert graph.context.ok(), "the manager goes on"
    # It is there again, and does not answer.
    graph.add(ScriptedCoder).is_mute = True
    assert _finished(graph, manager) == EXIT_FAULT
    assert "the run cannot continue: no message for 0.3 s; missing: " in capfd.readouterr().err


def test_under_supervision_learning_steps_must_fit(graph, nodes, tmp_path, capfd) -> None:
    # The scripted learners never learn: the second iteration of training shows it.
    assert _finished(graph, _start(graph, tmp_path / "run", supervised=True)) == EXIT_FAULT
    assert "expected 1 learning steps in episode 0, got 0" in capfd.readouterr().err


def test_without_supervision_a_gap_is_waited_out(graph, nodes, tmp_path, capfd) -> None:
    _, coder, _ = nodes
    coder.is_mute = True
    manager = _start(graph, tmp_path / "run", gap_s=0.3)
    _spin_until_said(graph, capfd, "no message for 0.3 s; missing: ")
    coder.is_mute = False
    assert _finished(graph, manager) == 0
    tables = Bag(tmp_path / "run" / "bag").vectors("episode")
    # What the plant said twice is recorded once.
    assert len(tables["episode"].stamps_ns) == N_OBSERVATIONS


def _with_a_mute_coder(graph, nodes, directory: Path) -> ExperimentManagerNode:
    """Start a run up to its first episode, which the coder does not answer."""
    plant, coder, _ = nodes
    coder.is_mute = True
    manager = _start(graph, directory)
    graph.spin_until(lambda: plant.episodes, "the first episode")
    return manager


def test_a_second_publisher_is_a_fault(graph, nodes, tmp_path, capfd) -> None:
    manager = _with_a_mute_coder(graph, nodes, tmp_path / "run")
    VectorPublisher(nodes[2], "reward", reward_names())
    assert _finished(graph, manager) == EXIT_FAULT
    assert "expected one publisher per topic, found more on reward" in capfd.readouterr().err


def test_of_a_node_that_was_killed_and_started_again_the_first_is_waited_out(
    graph, nodes, tmp_path, capfd
) -> None:
    """The dead one is in the graph until its lease ends; here it is a mute one that leaves."""
    manager = _with_a_mute_coder(graph, nodes, tmp_path / "run")
    plant, dead, _ = nodes
    coder = graph.add(ScriptedCoder)
    # The new one answers, so the episode comes to its end, and is held there.
    _spin_until_said(graph, capfd, "waiting for one of two publishers of reward to go")
    graph.spin_until(lambda: _is_held(manager), "the end of the episode")
    assert len(plant.episodes) == 1
    graph.remove(dead)
    assert _finished(graph, manager) == 0
    # What the dead one had learned until the last checkpoint, the new one goes on from.
    assert coder.asked[:3] == ["start_run", "load", "save"]
    assert len(Bag(tmp_path / "run" / "bag").stamps_ns("episode")) == N_OBSERVATIONS


def test_a_node_that_is_started_again_later_goes_on_from_the_newest_checkpoint(
    graph, nodes, tmp_path, capfd
) -> None:
    manager = _with_a_mute_coder(graph, nodes, tmp_path / "run")
    graph.remove(nodes[1])
    _spin_until_said(graph, capfd, "waiting for reward")
    coder = graph.add(ScriptedCoder)
    assert _finished(graph, manager) == 0
    assert coder.asked[:3] == ["start_run", "load", "save"]


def test_a_plant_that_is_started_again_rolls_the_run_back(graph, nodes, tmp_path, capfd) -> None:
    """During an episode it is only found by what it is asked."""
    nodes[1].is_mute = True
    manager = _start(graph, tmp_path / "run", gap_s=0.3)
    graph.spin_until(lambda: nodes[0].episodes, "the first episode")
    # Of one that is still the same, the question changes nothing.
    _spin_until_said(graph, capfd, "no message for 0.3 s; missing: ")
    graph.spin_until(lambda: manager._n_awaited == 1, "the answer")
    assert nodes[0].asked == ["start_run", "episode"]
    graph.remove(nodes[0])
    graph.add(ScriptedPlant)
    assert _finished(graph, manager) == EXIT_ROLL_BACK
    error = capfd.readouterr().err
    assert "eye_plant was started again: rolling back to the newest checkpoint" in error
    assert "the run cannot continue" not in error


def _is_held(manager: ExperimentManagerNode) -> bool:
    record = manager._recorder.record
    return record is not None and record.is_complete


def test_a_second_node_of_one_name_that_stays_is_a_fault(
    graph, nodes, tmp_path, capfd, monkeypatch
) -> None:
    monkeypatch.setattr(presence, "LEASE_S", 0.0)
    manager = _with_a_mute_coder(graph, nodes, tmp_path / "run")
    graph.add(ScriptedCoder)
    assert _finished(graph, manager) == EXIT_FAULT
    assert "expected one publisher per topic, found more on reward" in capfd.readouterr().err


def test_a_message_without_a_stamp_is_a_fault(graph, nodes, tmp_path, capfd) -> None:
    plant, coder, _ = nodes
    coder.is_mute = True
    clock = coder.create_publisher(Clock, "/clock", LOCKSTEP_QOS)
    manager = _start(graph, tmp_path / "run")
    graph.spin_until(lambda: plant.episodes and clock.get_subscription_count(), "an episode")
    clock.publish(b"\x00\x01\x00\x00")
    assert _finished(graph, manager) == EXIT_FAULT
    assert "expected a message with a header, got 4 bytes" in capfd.readouterr().err


def test_answers_to_the_last_observation_are_not_recorded(graph, nodes, tmp_path) -> None:
    nodes[1].answers_all = True
    manager = _start(graph, tmp_path / "run")
    assert _finished(graph, manager) == 0
    tables = Bag(tmp_path / "run" / "bag").vectors("reward", "actor_critic", "muscle_command")
    for table in tables.values():
        assert len(table.stamps_ns) == N_OBSERVATIONS - 4


def test_an_interrupt_ends_the_run_after_the_episode_and_it_can_be_resumed(graph, nodes, tmp_path):
    plant, coder, _ = nodes
    coder.is_mute = True
    manager = _start(graph, tmp_path / "run")
    graph.spin_until(lambda: plant.episodes, "the first episode")
    manager.interrupt()
    coder.is_mute = False
    assert _finished(graph, manager) == EXIT_INTERRUPTED
    assert len(plant.episodes) == 1
    manifests = sorted((tmp_path / "run" / "checkpoints").glob("*/manifest.json"))
    assert [path.parent.name for path in manifests] == ["000000000", "000000001"]
    with ros_graph() as again:
        others = again.add(ScriptedPlant), again.add(ScriptedCoder), again.add(ScriptedLearner)
        assert _finished(again, _start(again, tmp_path / "run", resume=True)) == 0
        assert [e.first_observation for e in others[0].episodes] == [21, 32, 43]
        assert others[1].asked[:2] == others[2].asked[:2] == ["start_run", "load"]
    tables = Bag(tmp_path / "run" / "bag").vectors("ground_truth")
    stamps_ns = np.arange(N_OBSERVATIONS) * PERIOD_NS
    assert tables["ground_truth"].stamps_ns.tolist() == stamps_ns.tolist()


def test_two_interrupts_end_the_run_at_once(graph, nodes, tmp_path) -> None:
    nodes[1].is_mute = True
    manager = _start(graph, tmp_path / "run")
    graph.spin_until(lambda: nodes[0].episodes, "the first episode")
    manager.interrupt()
    manager.interrupt()
    assert _finished(graph, manager) == EXIT_INTERRUPTED


def test_an_interrupt_while_waiting_for_others_ends_the_run(graph: Graph, tmp_path: Path) -> None:
    manager = _start(graph, tmp_path / "run")
    manager.interrupt()
    assert _finished(graph, manager) == EXIT_INTERRUPTED


def test_a_directory_that_holds_something_is_refused(graph: Graph, tmp_path: Path) -> None:
    (tmp_path / "run" / "bag").mkdir(parents=True)
    (tmp_path / "run" / "bag" / "bag_0.mcap").write_bytes(b"")
    with pytest.raises(InputError, match="expected a new or empty directory for the bag"):
        _start(graph, tmp_path / "run")
    with pytest.raises(InputError, match="expected a checkpoint to resume from, found none"):
        _start(graph, tmp_path / "run", resume=True)


def test_a_place_that_cannot_be_written_is_refused(graph: Graph, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="run directory: expected one to write into"):
        _start(graph, tmp_path / "file" / "run")


def test_a_plant_that_takes_no_requests_is_not_waited_for_for_ever(
    graph, tmp_path, monkeypatch, capfd
) -> None:
    monkeypatch.setattr(node_requests, "SERVICE_WAIT_S", 0.0)
    monkeypatch.setattr(node_requests, "PLANT_WAIT_S", 0.0)
    graph.add(ScriptedCoder)
    graph.add(ScriptedLearner)
    plant = graph.add(partial(Node, "my_plant"))
    for topic in PLANT_VECTORS:
        plant.create_publisher(JointState, topic, LOCKSTEP_QOS)
    plant.create_publisher(Image, "left/image_raw", LOCKSTEP_QOS)
    assert _finished(graph, _start(graph, tmp_path / "run")) == EXIT_FAULT
    assert "expected a plant with the service eye_plant/request" in capfd.readouterr().err


def test_another_configuration_is_not_resumed(graph, nodes, tmp_path) -> None:
    assert _finished(graph, _start(graph, tmp_path / "run")) == 0
    with (
        ros_graph() as again,
        pytest.raises(InputError, match=r"task\.seed was 1, is 2"),
    ):
        _start(again, tmp_path / "run", resume=True, seed=2)


def test_a_disk_that_refuses_ends_the_run_with_one_error(
    graph, nodes, tmp_path, capfd, monkeypatch
) -> None:
    manager = _start(graph, tmp_path / "run")
    graph.spin_until(lambda: nodes[0].episodes, "the first episode")

    def refuse(*arguments: Any) -> bool:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(manager.run.writer, "write", refuse)
    assert _finished(graph, manager) == EXIT_UNWRITABLE
    error = capfd.readouterr().err
    assert f"the run cannot continue: {tmp_path / 'run'} cannot be written: " in error
    assert "No space left on device" in error
