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
from experiment_manager.measures.results import RESULTS_FILE, read_results
from experiment_manager.run.recorded_topics import recorded_types
from lockstep import ALL_MUSCLES, COMMAND_SPACES, HORIZONTAL_RECTI, PAIR
from lockstep.wire.topics import TEST, TOPIC_TYPES
from tests.graph_harness import small_run
from tests.kept_tests import kept_tests
from tests.loop_contract import (
    N_TRAINING,
    N_TRIALS,
    assert_as_the_loop,
    run_line,
    whole_graph,
)
from tests.patience import PATIENCE_S
from tests.supervised_run import SupervisedRun, are_gone
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


def _interrupted_and_resumed(line: list[str], directory: Path, *, begins_in_process: bool) -> None:
    with SupervisedRun(line, directory, in_process=begins_in_process) as run:
        assert run.wait_until(lambda: run.place() >= 2, "a checkpoint")
        run.process.send_signal(signal.SIGINT)
        assert run.wait() == 130, run.output()
        assert "stopping after this episode, with a checkpoint" in run.output()
        option = " --in-process" if begins_in_process else ""
        assert f" run --resume {directory}{option}\n" in run.output()
        stopped_at = run.place()
    assert not (directory / "results.json").exists()
    with SupervisedRun(line, directory, resume=True, in_process=not begins_in_process) as run:
        assert run.wait() == 0, run.output()
        assert run.place() > stopped_at


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
        ("cacla", partial(_interrupted_and_resumed, begins_in_process=False)),
        ("hindsight", partial(_interrupted_and_resumed, begins_in_process=True)),
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


def _with_own_commands(pictures: Path, directory: Path, *settings: str) -> Path:
    """Make a run whose muscles have commands of their own, and check it against the loop."""
    line = run_line(
        pictures,
        "experiment_manager.n_starts_per_distance=4",
        "eyes.mechanics.parameter_set=anatomical",
        "eyes.mechanics.moves=at_once",
        *settings,
        rule="hindsight",
    )
    _interrupted_and_resumed(line, directory, begins_in_process=True)
    assert_as_the_loop(directory)
    return directory


def test_muscles_with_commands_of_their_own_are_recorded_as_the_loop_has_them(
    pictures, tmp_path
) -> None:
    settings = (
        f"task.command_space={HORIZONTAL_RECTI}",
        "task.lowest_activations=[0.01]",
        "task.highest_activations=[0.2]",
        "vergence_rl.hindsight.n_best=3",
        "task.price_rise_share=0.75",
    )
    directory = _with_own_commands(pictures, tmp_path / "run", *settings)
    command = Bag(directory / "bag").vectors("muscle_command")["muscle_command"]
    for name in COMMAND_SPACES[HORIZONTAL_RECTI].names:
        assert (command.column(name) >= 0.01).all()
    assert kept_tests(directory)[-1].activations.shape[-1] == 4


_TWELVE = (
    f"task.command_space={ALL_MUSCLES}",
    "task.lowest_activations=[0.0]",
    "task.highest_activations=[0.2]",
    "task.metabolic_cost_weight=0.3",
)


def test_eyes_that_make_saccades_are_recorded_as_the_loop_has_them(pictures, tmp_path) -> None:
    settings = (
        "task.fixation_iterations=5",
        "vergence_rl.products_of_activations=true",
        "vergence_rl.hindsight.n_best=2",
        "experiment_manager.gives_targets=false",
        "eyes.noise.turn_sd_deg=0.1",
    )
    directory = _with_own_commands(pictures, tmp_path / "run", *_TWELVE, *settings)
    gaze, truth = Bag(directory / "bag").vectors("gaze", "ground_truth").values()
    # In tests the protocol gives the targets, in training the eyes choose among patches.
    chosen = gaze.column("target_sideways_deg")
    assert np.isfinite(chosen[::5]).all()
    in_test = truth.column("phase") == TEST
    assert (truth.column("target_sideways_deg")[in_test] != 0.0).all()
    assert not truth.column("target_sideways_deg")[~in_test].any()
    # From the second change on the left eye is covered, so that its movements are not seen.
    turns_deg = gaze.column("left_up_deg")[1::5]
    assert np.isfinite(turns_deg[0])
    assert np.isnan(turns_deg[-1])
    (summary, *_) = read_results(directory / RESULTS_FILE).tests
    assert summary.saccade_error_deg["after_2"].median > 0.0
    kept = kept_tests(directory)[-1]
    assert kept.activations.shape[-1] == 12
    assert np.isfinite(kept.column("cyclovergence_error_deg")[:, -1]).all()


def test_vergence_by_turns_without_saccades_is_recorded_as_the_loop_has_it(
    pictures, tmp_path
) -> None:
    turns = "task.measures_turns=true"
    directory = _with_own_commands(pictures, tmp_path / "run", *_TWELVE, turns)
    (gaze,) = Bag(directory / "bag").vectors("gaze").values()
    assert np.isnan(gaze.column("target_up_deg")).all()
    # Before they have learned, the eyes do not move in a test.
    for name in ("left_up_deg", "right_up_deg"):
        assert gaze.column(name)[[1, 6]] == pytest.approx(0.0, abs=1e-3)
        assert np.isnan(gaze.column(name)[[0, 2]]).all()


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
    assert (again / "results.json").read_text() == (run / "results.json").read_text()
    assert_as_the_loop(again)
