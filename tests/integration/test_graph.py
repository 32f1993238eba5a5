"""Graph and one process compute what the loop does, and record it alike, however they take turns.

The contract itself is assert_as_the_loop; test_faults.py, test_hosts.py, test_node_by_node.py,
test_resources.py and test_live_view.py hold disturbed graphs to it.
"""

import json
import resource
import shutil
import signal
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from mcap.reader import make_reader
from mcap_ros2.reader import read_ros2_messages
from rosbags.highlevel import AnyReader

from experiment_manager import Bag
from experiment_manager.run.recorded_topics import recorded_types
from lockstep import COMMAND_SPACES, PAIR
from lockstep.wire.topics import TOPIC_TYPES
from tests.graph_harness import small_run
from tests.loop_contract import (
    N_TRAINING,
    N_TRIALS,
    assert_as_the_loop,
    run_line,
    whole_graph,
)
from tests.patience import PATIENCE_S
from tests.supervised_run import SupervisedRun, are_gone, interrupted_and_resumed
from tests.supervisor import finished, start_supervisor

pytestmark = pytest.mark.graph

N_ANSWERED = N_TRAINING + 20 * N_TRIALS
# Of each node's health, by the clock on the wall.
NOT_COMPARED = "/diagnostics"


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory, pictures: Path) -> Path:
    """Return the directory of a run of model M_C that a graph has made."""
    return whole_graph(tmp_path_factory, pictures)


def _whole_run(line: list[str], directory: Path) -> None:
    with SupervisedRun(line, directory, in_process=True) as run:
        assert run.wait() == 0, run.output()


def _killed_in_process_and_as_a_graph(line: list[str], directory: Path) -> None:
    for n_episodes, in_process in ((1, True), (12, False)):
        is_begun = n_episodes > 1
        with SupervisedRun(line, directory, resume=is_begun, in_process=in_process) as run:
            assert run.wait_until(partial(_is_beyond, run, n_episodes), "a checkpoint")
            nodes = run.nodes()
            run.process.kill()
            run.process.wait(PATIENCE_S)
            assert are_gone(nodes.values())
    with SupervisedRun(line, directory, resume=True, in_process=True) as run:
        assert run.wait() == 0, run.output()


def _out_of_disk_and_stopped_at_once(line: list[str], directory: Path) -> None:
    with SupervisedRun(line, directory, in_process=True) as run:
        assert run.wait_until(partial(_is_beyond, run, 1), "a checkpoint")
        resource.prlimit(run.process.pid, resource.RLIMIT_FSIZE, (5000, 5000))
        assert run.wait() == 3, run.output()
        assert run.output().count("error: ") == 1
        assert f"{directory} cannot be written: " in run.output()
        stopped_at = run.place()
    with SupervisedRun(line, directory, resume=True, in_process=True) as run:
        assert run.wait_until(partial(_is_beyond, run, stopped_at + 1), "another checkpoint")
        run.process.send_signal(signal.SIGTERM)
        run.process.send_signal(signal.SIGINT)
        assert run.wait() == 130, run.output()
    with SupervisedRun(line, directory, resume=True, in_process=True) as run:
        assert run.wait() == 0, run.output()


def _is_beyond(run: SupervisedRun, n_episodes: int) -> bool:
    return run.place() >= n_episodes


@pytest.mark.parametrize(
    ("rule", "make"),
    [
        ("cacla", _whole_run),
        ("cacla", partial(interrupted_and_resumed, begins_in_process=False)),
        ("hindsight", partial(interrupted_and_resumed, begins_in_process=True)),
        ("hindsight", _killed_in_process_and_as_a_graph),
        ("cacla", _out_of_disk_and_stopped_at_once),
    ],
    ids=["whole", "from graph to process", "from process to graph", "killed", "no disk"],
)
def test_a_run_records_what_the_loop_computes(pictures, run, tmp_path, rule, make) -> None:
    directory = tmp_path / "run"
    make(run_line(pictures, rule=rule), directory)
    assert_as_the_loop(directory)
    if rule == "cacla":
        _assert_same_files(directory, run)
    if make in (_whole_run, _out_of_disk_and_stopped_at_once):  # without a graph, none is late
        assert _order(directory) == sorted(_order(directory))


def test_a_graph_records_what_the_loop_computes(run: Path) -> None:
    assert_as_the_loop(run)


def _assert_same_files(one: Path, other: Path) -> None:
    assert _configuration(one) == _configuration(other)
    # What reaches a graph's recorder more than a second late lies behind younger messages.
    assert sorted(_order(one)) == sorted(_order(other))
    assert (one / "results.json").read_text() == (other / "results.json").read_text()
    assert {path.name for path in (one / "figures").iterdir()} == {
        path.name for path in (other / "figures").iterdir()
    }


def _order(directory: Path) -> list[tuple[int, int]]:
    """Return stamp and place in the table of topics of each message, as the files have them."""
    places = {f"/{topic.removeprefix('/')}": i for i, topic in enumerate(TOPIC_TYPES)}
    found = []
    for i_file in range(len([*(directory / "bag").glob("*.mcap")])):
        with (directory / "bag" / f"bag_{i_file}.mcap").open("rb") as stream:
            for _, channel, message in make_reader(stream).iter_messages(log_time_order=False):
                # The plant may repeat its clock, as nobody misses it.
                if channel.topic not in ("/clock", NOT_COMPARED):
                    found.append((message.log_time, places[channel.topic]))
    return found


def _configuration(directory: Path) -> dict[str, dict[str, object]]:
    document = yaml.safe_load((directory / "config.yaml").read_text())
    del document["run"]["ros__parameters"]["date"]
    return document


def test_pictures_are_of_the_sampled_episodes(run: Path) -> None:
    # Episodes 0, 7, ... 28 of training and trials 0, 3 of both tests, with and without answers.
    bag = Bag(run / "bag")
    assert len(bag.stamps_ns("features")) == 5 * 10 + 4 * 20
    assert len(bag.stamps_ns("left/camera_info")) == len(bag.stamps_ns("right/image_raw")) == 130


def test_a_schedule_is_recorded(run: Path) -> None:
    with AnyReader([run / "bag"]) as bag:
        found = [
            (bag.deserialize(raw, connection.msgtype), stamp_ns)
            for connection, stamp_ns, raw in bag.messages(
                [c for c in bag.connections if c.topic == "/parameter_changes"]
            )
        ]
    told = [dict(zip(message.name, message.position, strict=True)) for message, _ in found]
    assert told == [
        {
            "eyes.mechanics.rest_adduction_deg[0]": 0.0,
            "eyes.mechanics.rest_adduction_deg[1]": 1.5,
            "eyes.camera.left_blur_px": 2.5,
            "eyes.camera.left_magnification": 1.1,
        },
        {
            "eyes.camera.left_blur_px": 0.0,
            "eyes.camera.left_occluded": 1.0,
            "eyes.noise.picture_sd": 4.0,
            "eyes.noise.missing_pictures": 0.2,
            "eyes.noise.activation_sd": 0.004,
            "eyes.noise.missing_activations": 0.2,
        },
    ]
    truth = Bag(run / "bag").vectors("ground_truth")["ground_truth"]
    rows = truth.at(np.array([stamp_ns for _, stamp_ns in found]))
    assert truth.column("training_iteration")[rows].tolist() == [90, 180]
    assert truth.column("iteration")[rows].tolist() == [0, 0]


def test_every_reader_decodes_every_message(run: Path) -> None:
    n_rosbags = dict.fromkeys(TOPIC_TYPES, 0)
    last_ns = dict.fromkeys(TOPIC_TYPES, -1)
    with AnyReader([run / "bag"]) as reader:
        assert {c.topic.removeprefix("/"): c.msgtype for c in reader.connections} == {
            topic.removeprefix("/"): kind
            for topic, kind in recorded_types(COMMAND_SPACES[PAIR]).items()
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
    assert n_rosbags["/clock"] > N_ANSWERED // 2
    assert n_rosbags["/diagnostics"] > 0


def test_the_run_says_what_it_is(run: Path) -> None:
    results = json.loads((run / "results.json").read_text())
    assert (results["model"], results["seed"], results["iterations"]) == ("M_C", 1, N_TRAINING)
    assert [(t["iteration"], t["n_trials"]) for t in results["tests"]] == [(0, 4), (N_TRAINING, 4)]
    bag = Bag(run / "bag")
    assert bag.attachment("config.yaml") == (run / "config.yaml").read_bytes()
    assert bag.metadata["run"]["model"] == "M_C"


def test_a_directory_that_holds_a_run_is_refused(run: Path, pictures: Path) -> None:
    before = sorted(run.rglob("*"))
    output = finished(start_supervisor([*small_run(pictures), "--out", str(run)]), code=2)
    assert output.count("error: ") == 1
    assert f"{run}: expected a new or empty directory, it is not empty" in output
    assert sorted(run.rglob("*")) == before


def test_resuming_a_finished_run_changes_nothing_but_says_its_results(run, tmp_path) -> None:
    again = tmp_path / "run"
    shutil.copytree(run, again)
    output = finished(start_supervisor(["--resume", str(again)]))
    assert f"results: {again / 'results.json'}" in output
    files = {path.relative_to(run) for path in run.rglob("*") if path.is_file()}
    assert files == {path.relative_to(again) for path in again.rglob("*") if path.is_file()}
    for file in files:
        # The figure is drawn again, nodes write their logs, and a manifest names the directory.
        if file.parts[0] not in ("figures", "logs") and file.name != "manifest.json":
            assert (again / file).read_bytes() == (run / file).read_bytes(), file
