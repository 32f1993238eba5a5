"""A run in one process leaves the files of a graph, however the two take turns at it."""

import resource
import signal
from functools import partial
from pathlib import Path

import numpy as np
import pytest
import yaml
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader

from experiment_manager.bag.reader import Bag
from tests.graph_harness import small_run
from tests.stress.supervised_run import SupervisedRun

N_TRAINING = 300
SETTINGS = (
    "experiment_manager.checkpoint_period_s=0.3",
    "sparse_coder.n_bases=32",
    "vergence_rl.n_features=64",
    "eye_plant.camera.roi_width_px=130",
    "eye_plant.camera.roi_height_px=130",
    # Disease and treatment: of the muscles, of what one eye sees, and of what must be drawn for it.
    "experiment_manager.schedule=["
    "{at: 90, set: {eye_plant.mechanics.rest_adduction_deg: [0.0, 1.5],"
    " eye_plant.camera.left_blur_px: 2.5, eye_plant.camera.focal_length_px: 250}},"
    "{at: 180, set: {eye_plant.camera.left_blur_px: 0.0, eye_plant.camera.left_occluded: true}}]",
)
# Of each node's health, by the clock on the wall.
NOT_COMPARED = "/diagnostics"


@pytest.fixture(scope="module", params=["cacla", "hindsight"])
def line(pictures: Path, request: pytest.FixtureRequest) -> list[str]:
    """Return the command line of a run with many checkpoints, by either rule."""
    rule = f"vergence_rl.learning_rule={request.param}"
    return [*small_run(pictures, N_TRAINING, *SETTINGS, rule), "--model", "M_C"]


@pytest.fixture(scope="module")
def graph(tmp_path_factory: pytest.TempPathFactory, line: list[str]) -> Path:
    """Return the directory of a run that a graph has made whole."""
    return _whole(tmp_path_factory.mktemp("graph") / "run", line, in_process=False)


def _whole(directory: Path, line: list[str], *, in_process: bool) -> Path:
    with SupervisedRun(line, directory, in_process=in_process) as run:
        assert run.wait() == 0, run.output()
    return directory


def test_a_schedule_is_recorded(graph: Path) -> None:
    with AnyReader([graph / "bag"]) as bag:
        found = [
            (bag.deserialize(raw, connection.msgtype), stamp_ns)
            for connection, stamp_ns, raw in bag.messages(
                [c for c in bag.connections if c.topic == "/parameter_changes"]
            )
        ]
    told = [dict(zip(message.name, message.position, strict=True)) for message, _ in found]
    assert told == [
        {
            "eye_plant.mechanics.rest_adduction_deg[0]": 0.0,
            "eye_plant.mechanics.rest_adduction_deg[1]": 1.5,
            "eye_plant.camera.left_blur_px": 2.5,
            "eye_plant.camera.focal_length_px": 250.0,
        },
        {"eye_plant.camera.left_blur_px": 0.0, "eye_plant.camera.left_occluded": 1.0},
    ]
    truth = Bag(graph / "bag").vectors("ground_truth")["ground_truth"]
    rows = truth.at(np.array([stamp_ns for _, stamp_ns in found]))
    assert truth.column("training_iteration")[rows].tolist() == [90, 180]
    assert truth.column("iteration")[rows].tolist() == [0, 0]


def _messages(directory: Path) -> dict[str, dict[int, bytes]]:
    """Return the bytes of a bag's messages by topic and stamp."""
    found: dict[str, dict[int, bytes]] = {}
    for path in sorted((directory / "bag").glob("*.mcap")):
        with path.open("rb") as stream:
            for _, channel, message in make_reader(stream).iter_messages(log_time_order=False):
                stamps = found.setdefault(channel.topic, {})
                # The plant may repeat its clock, as nobody misses it.
                assert channel.topic in ("/clock", NOT_COMPARED) or message.log_time not in stamps
                stamps[message.log_time] = message.data
    return found


def _order(directory: Path) -> list[tuple[str, int]]:
    """Return topic and stamp of one message after the other, as the files have them."""
    found = []
    for i_file in range(len([*(directory / "bag").glob("*.mcap")])):
        with (directory / "bag" / f"bag_{i_file}.mcap").open("rb") as stream:
            for _, channel, message in make_reader(stream).iter_messages(log_time_order=False):
                if channel.topic not in ("/clock", NOT_COMPARED):
                    found.append((channel.topic, message.log_time))
    return found


def _configuration(directory: Path) -> dict[str, dict[str, object]]:
    document = yaml.safe_load((directory / "config.yaml").read_text())
    del document["run"]["ros__parameters"]["date"]
    return document


def _learned(directory: Path) -> dict[str, bytes]:
    """Return the last checkpoint's arrays, byte by byte."""
    newest = sorted((directory / "checkpoints").glob("*/manifest.json"))[-1].parent
    return {
        f"{newest.name}/{path.name}/{name}": array.tobytes()
        for path in sorted(newest.glob("*.npz"))
        for name, array in np.load(path).items()
    }


def _assert_same(one: Path, other: Path) -> None:
    assert _configuration(one) == _configuration(other)
    first, second = _messages(one), _messages(other)
    first.pop(NOT_COMPARED, None)
    second.pop(NOT_COMPARED, None)
    assert {topic: len(its) for topic, its in first.items()} == {
        topic: len(its) for topic, its in second.items()
    }
    for topic, messages in first.items():
        assert messages == second[topic], topic
    assert _order(one) == _order(other)
    assert _learned(one) == _learned(other)
    assert (one / "results.json").read_text() == (other / "results.json").read_text()
    assert {path.name for path in (one / "figures").iterdir()} == {
        path.name for path in (other / "figures").iterdir()
    }


def test_one_process_writes_what_the_graph_writes(
    line: list[str], graph: Path, tmp_path: Path
) -> None:
    single = _whole(tmp_path / "run", line, in_process=True)
    _assert_same(single, graph)
    messages = _messages(single)
    assert NOT_COMPARED not in messages
    # Episodes 0, 7, ... 28 of training and trials 0, 3 of both tests, with and without answers.
    assert len(messages["/features"]) == 5 * 10 + 4 * 20
    assert len(messages["/left/camera_info"]) == len(messages["/right/image_raw"]) == 130


@pytest.mark.parametrize("begins_in_process", [False, True])
def test_each_goes_on_with_what_the_other_has_begun(
    line: list[str], graph: Path, tmp_path: Path, begins_in_process: bool
) -> None:
    directory = tmp_path / "run"
    with SupervisedRun(line, directory, in_process=begins_in_process) as run:
        assert run.wait_until(lambda: run.place() >= 2, "a checkpoint")
        run.process.send_signal(signal.SIGINT)
        assert run.wait() == 130, run.output()
        assert "stopping after this episode, with a checkpoint" in run.output()
        option = " --in-process" if begins_in_process else ""
        assert f"run_experiment.sh --resume {directory}{option}\n" in run.output()
        stopped_at = run.place()
    assert not (directory / "results.json").exists()
    with SupervisedRun(line, directory, resume=True, in_process=not begins_in_process) as run:
        assert run.wait() == 0, run.output()
        assert run.place() > stopped_at
    _assert_same(directory, graph)


def _is_beyond(run: SupervisedRun, n_episodes: int) -> bool:
    return run.place() >= n_episodes


def test_a_killed_process_goes_on_from_its_checkpoint_and_so_does_a_killed_graph(
    line: list[str], graph: Path, tmp_path: Path
) -> None:
    directory = tmp_path / "run"
    for n_episodes, in_process in ((1, True), (12, False)):
        is_begun = n_episodes > 1
        with SupervisedRun(line, directory, resume=is_begun, in_process=in_process) as run:
            assert run.wait_until(partial(_is_beyond, run, n_episodes), "a checkpoint")
            run.process.kill()
            run.process.wait()
    with SupervisedRun(line, directory, resume=True, in_process=True) as run:
        assert run.wait() == 0, run.output()
    _assert_same(directory, graph)


def test_a_second_signal_stops_at_once(line: list[str], tmp_path: Path) -> None:
    directory = tmp_path / "run"
    with SupervisedRun(line, directory, in_process=True) as run:
        assert run.wait_until(lambda: run.place() >= 0, "the first checkpoint")
        run.process.send_signal(signal.SIGTERM)
        run.process.send_signal(signal.SIGINT)
        assert run.wait() == 130, run.output()
    with SupervisedRun(line, directory, resume=True, in_process=True) as run:
        assert run.wait() == 0, run.output()


def test_a_full_disk_is_said_and_what_was_saved_is_whole(
    line: list[str], graph: Path, tmp_path: Path
) -> None:
    directory = tmp_path / "run"
    with SupervisedRun(line, directory, in_process=True) as run:
        assert run.wait_until(partial(_is_beyond, run, 1), "a checkpoint")
        resource.prlimit(run.process.pid, resource.RLIMIT_FSIZE, (1000, 1000))
        assert run.wait() == 3, run.output()
        assert run.output().count("error: ") == 1
        assert f"{directory} cannot be written: " in run.output()
    with SupervisedRun(line, directory, resume=True, in_process=True) as run:
        assert run.wait() == 0, run.output()
    _assert_same(directory, graph)


def test_nodes_elsewhere_are_none_of_one_process(line: list[str], tmp_path: Path) -> None:
    with SupervisedRun(line, tmp_path / "run", in_process=True, elsewhere=["eye_plant"]) as run:
        assert run.wait() == 2
        assert "error: --in-process: expected it without --elsewhere, got both\n" in run.output()
    assert not (tmp_path / "run").exists()
