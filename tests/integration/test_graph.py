"""The graph as processes: the same numbers as the loop in one process, and a bag of all of them."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap_ros2.reader import read_ros2_messages
from rosbags.highlevel import AnyReader

from experiment_manager.bag.reader import Bag
from lockstep.wire.topics import (
    CODER_VECTORS,
    GROUND_TRUTH_NAMES,
    LEARNER_VECTORS,
    PICTURES,
    PLANT_VECTORS,
    REWARD_NAMES,
    TOPIC_TYPES,
)
from tests.graph_harness import OracleRun, small_run, stacked, vectors
from tests.pair import ACTOR_CRITIC_NAMES, COMMAND_NAMES
from tests.supervisor import finished, start_supervisor

N_TRAINING, N_TRIALS = 200, 8
N_ANSWERED = N_TRAINING + 20 * N_TRIALS
N_OBSERVATIONS = N_ANSWERED + N_TRAINING // 10 + N_TRIALS


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory, pictures: Path) -> Path:
    """Return the directory of a finished run of model M_C."""
    directory = tmp_path_factory.mktemp("graph") / "run"
    line = small_run(pictures, N_TRAINING)
    finished(start_supervisor([*line, "--model", "M_C", "--out", str(directory)]))
    return directory


def test_the_graph_computes_what_the_loop_in_one_process_does(run: Path) -> None:
    oracle = OracleRun(run / "config.yaml")
    expected: dict[str, list[Any]] = {"ground_truth": [], "reward": [], "muscle_command": []}
    expected |= {"actor_critic": [], "lengths": [], "forces": [], "angles": []}
    bag = Bag(run / "bag")
    recorded = {topic: dict(bag.images(topic)) for topic in (*PICTURES, "features")}
    period_ns = int(np.diff(bag.stamps_ns("episode")[:2])[0])
    n_compared = 0
    for _, step in oracle.steps():
        observation, answer = step.observation, step.answer
        expected["ground_truth"].append(observation.ground_truth_values())
        expected["lengths"].append(observation.state.lengths_m)
        expected["forces"].append(observation.state.forces_n)
        expected["angles"].append(observation.state.eye_angles_rad.ravel())
        if answer is None or observation.pictures is None:
            continue
        expected["reward"].append(answer.percept.reward_values())
        decision = answer.decision
        expected["muscle_command"].append(decision.command)
        expected["actor_critic"].append(
            (
                decision.value,
                decision.td_error,
                decision.td_variance,
                decision.actor_learning_rate,
                decision.critic_learning_rate,
                *decision.action,
                oracle.agent.learning_steps,
            )
        )
        stamp_ns = observation.number * period_ns
        if stamp_ns in recorded["features"]:
            n_compared += 1
            assert (
                recorded["features"][stamp_ns].tobytes()
                == answer.percept.encoding.features.tobytes()
            )
            for topic, picture in zip(PICTURES, observation.pictures, strict=True):
                assert recorded[topic][stamp_ns].tobytes() == picture.tobytes()
    got = vectors(run)
    assert got["ground_truth"].names == GROUND_TRUTH_NAMES
    assert got["reward"].names == REWARD_NAMES
    assert got["muscle_command"].names == COMMAND_NAMES
    assert got["actor_critic"].names == ACTOR_CRITIC_NAMES
    pairs = {
        "ground_truth": got["ground_truth"].position,
        "reward": got["reward"].position,
        "muscle_command": got["muscle_command"].position,
        "actor_critic": got["actor_critic"].position,
        "lengths": got["muscle_states"].position,
        "forces": got["muscle_states"].effort,
        "angles": got["eye_states"].position,
    }
    for name, values in pairs.items():
        np.testing.assert_array_equal(values, stacked(expected[name]), err_msg=name)
    # Episodes 0, 7, 14 of training and trials 0, 3 of two tests were sampled with pictures.
    assert n_compared == 3 * 10 + 4 * 20


def test_exactly_one_of_each_small_message_per_stamp(run: Path) -> None:
    tables = vectors(run)
    stamps_ns = tables["episode"].stamps_ns
    period_ns = int(stamps_ns[1] - stamps_ns[0])
    every = np.arange(N_OBSERVATIONS) * period_ns
    iteration = tables["episode"].column("iteration")
    phase = tables["episode"].column("phase")
    answered = every[iteration < np.where(phase == 0, 10, 20)]
    assert len(answered) == N_ANSWERED
    for topic in PLANT_VECTORS:
        assert tables[topic].stamps_ns.tolist() == every.tolist()
    for topic in (*CODER_VECTORS, *LEARNER_VECTORS):
        assert tables[topic].stamps_ns.tolist() == answered.tolist()


def test_every_reader_decodes_every_message(run: Path) -> None:
    n_rosbags = dict.fromkeys(TOPIC_TYPES, 0)
    last_ns = dict.fromkeys(TOPIC_TYPES, -1)
    with AnyReader([run / "bag"]) as reader:
        assert {c.topic.removeprefix("/"): c.msgtype for c in reader.connections} == {
            topic.removeprefix("/"): kind for topic, kind in TOPIC_TYPES.items()
        }
        for connection, stamp_ns, data in reader.messages():
            message: Any = reader.deserialize(data, connection.msgtype)
            topic = connection.topic
            name = topic if topic in TOPIC_TYPES else topic.removeprefix("/")
            n_rosbags[name] += 1
            if name not in ("/clock", "/diagnostics"):
                header = message.header.stamp
                assert header.sec * 10**9 + header.nanosec == stamp_ns
                assert stamp_ns > last_ns[name]
            last_ns[name] = stamp_ns
    n_mcap = dict.fromkeys(TOPIC_TYPES, 0)
    for path in sorted((run / "bag").glob("*.mcap")):
        for item in read_ros2_messages(path):
            topic = item.channel.topic
            n_mcap[topic if topic in TOPIC_TYPES else topic.removeprefix("/")] += 1
            assert item.log_time_ns == item.publish_time_ns
    assert n_mcap == n_rosbags
    assert n_rosbags["reward"] == N_ANSWERED
    assert n_rosbags["/clock"] > N_OBSERVATIONS // 2
    assert n_rosbags["/diagnostics"] > 0


def test_results_are_of_both_tests(run: Path) -> None:
    results = json.loads((run / "results.json").read_text())
    assert (results["model"], results["seed"], results["iterations"]) == ("M_C", 1, N_TRAINING)
    assert [(t["iteration"], t["n_trials"]) for t in results["tests"]] == [(0, 4), (200, 4)]
    tables = vectors(run)
    truth = tables["ground_truth"]
    for i_test, test in enumerate(results["tests"]):
        rows = (truth.column("test") == i_test) & (truth.column("iteration") == 20)
        errors_deg = np.abs(truth.column("vergence_error_deg")[rows])
        assert test["median_abs_vergence_error_deg"] == pytest.approx(np.median(errors_deg))


def test_the_bag_carries_its_configuration(run: Path) -> None:
    bag = Bag(run / "bag")
    assert bag.attachment("config.yaml") == (run / "config.yaml").read_bytes()
    assert bag.metadata["run"]["model"] == "M_C"


def test_a_directory_that_holds_a_run_is_refused(run: Path, pictures: Path) -> None:
    before = sorted(run.rglob("*"))
    output = finished(start_supervisor([*small_run(pictures), "--out", str(run)]), code=2)
    assert output.count("error: ") == 1
    assert f"{run}: expected a new or empty directory, it already holds something" in output
    assert sorted(run.rglob("*")) == before


def test_resuming_a_finished_run_changes_nothing_but_says_its_results(run: Path) -> None:
    before = vectors(run)["ground_truth"].position.tobytes()
    results = (run / "results.json").read_text()
    output = finished(start_supervisor(["--resume", str(run)]))
    assert f"results: {run / 'results.json'}" in output
    assert vectors(run)["ground_truth"].position.tobytes() == before
    assert (run / "results.json").read_text() == results
