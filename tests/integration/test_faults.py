"""Nodes that die or hang: the run rolls back, and ends with the numbers of an undisturbed one."""

import signal
from collections.abc import Callable
from pathlib import Path

import pytest

from experiment_manager.supervision.processes import PACKAGES
from tests.graph_harness import small_run
from tests.stress.supervised_run import (
    SupervisedRun,
    are_gone,
    differences,
    is_alive,
    is_intact,
    stamp_faults,
)

N_TRAINING = 400
SETTINGS = (
    "experiment_manager.checkpoint_period_s=0.5",
    "experiment_manager.gap_s=8.0",
    "sparse_coder.n_bases=32",
    "vergence_rl.n_features=64",
)


@pytest.fixture(scope="module")
def line(pictures: Path) -> list[str]:
    """Return the command line of a run with a checkpoint every half second."""
    return small_run(pictures, N_TRAINING, *SETTINGS)


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory, line: list[str]) -> Path:
    """Return the directory of a run that nothing disturbed: one in one process."""
    directory = tmp_path_factory.mktemp("undisturbed") / "run"
    with SupervisedRun(line, directory, in_process=True) as run:
        assert run.wait() == 0, run.output()
    assert stamp_faults(directory) == []
    return directory


def _beyond(run: SupervisedRun, n_episodes: int) -> Callable[[], bool]:
    """Return whether a checkpoint beyond so many episodes is there, and the bag goes on."""
    return lambda: run.place() >= n_episodes and len(run.nodes()) == len(PACKAGES)


def _wait_for_rollback(run: SupervisedRun) -> None:
    """Wait until none of the nodes of now is left."""
    nodes = run.nodes().values()
    assert run.wait_until(lambda: not any(is_alive(i) for i in nodes), "the roll-back")


def _recording(run: SupervisedRun) -> Callable[[], bool]:
    n_before = len(list((run.directory / "bag").glob("*.mcap")))
    return lambda: len(list((run.directory / "bag").glob("*.mcap"))) > n_before


def test_each_node_killed_once_and_one_stopped(
    line: list[str], undisturbed: Path, tmp_path: Path
) -> None:
    directory = tmp_path / "run"
    with SupervisedRun(line, directory) as run:
        # One that is only starting, before there is any checkpoint ...
        assert run.wait_until(lambda: "eye_plant" in run.nodes(), "the first nodes")
        assert run.signal_node("eye_plant", signal.SIGKILL)
        # ... then all others, each at another point of the run ...
        for i, package in enumerate(("sparse_coder", "experiment_manager", "vergence_rl")):
            assert run.wait_until(_beyond(run, 1 + 8 * i), f"a checkpoint before {package} dies")
            assert run.wait_until(_recording(run), "a message after the checkpoint")
            assert run.signal_node(package, signal.SIGKILL)
            _wait_for_rollback(run)
        # ... and one that only hangs, once it works again: one that starts has two minutes.
        assert run.wait_until(_beyond(run, run.place() + 1), "a checkpoint before the hang")
        assert run.signal_node("sparse_coder", signal.SIGSTOP)
        assert run.wait() == 0, run.output()
        output = run.output()
    for fault in (
        "fault: eye_plant was killed by SIGKILL",
        "fault: sparse_coder was killed by SIGKILL",
        "fault: experiment_manager was killed by SIGKILL",
        "fault: vergence_rl was killed by SIGKILL",
    ):
        assert output.count(fault) == 1, output
    # Whoever misses the hanging node first says so: the manager, or during a checkpoint we do.
    hang = ("ended: no message for 8 s; missing: ", "fault: sparse_coder gives no sign of life")
    assert sum(output.count(text) for text in hang) == 1, output
    assert differences(directory, undisturbed) == []
    assert stamp_faults(directory) == []


def test_a_killed_supervisor_takes_its_nodes_with_it_and_the_run_goes_on(
    line: list[str], undisturbed: Path, tmp_path: Path
) -> None:
    directory = tmp_path / "run"
    with SupervisedRun(line, directory) as run:
        assert run.wait_until(_beyond(run, 5), "a checkpoint")
        nodes = run.nodes()
        run.process.kill()
        run.process.wait()
        assert are_gone(nodes.values())
    with SupervisedRun(line, directory, resume=True) as run:
        # Ctrl-C: the episode under way is ended, a checkpoint made.
        assert run.wait_until(_beyond(run, run.place() + 1), "another checkpoint")
        run.process.send_signal(signal.SIGINT)
        assert run.wait() == 130, run.output()
        assert f"--resume {directory}" in run.output()
        assert is_intact(directory)
    with SupervisedRun(line, directory, resume=True) as run:
        assert run.wait() == 0, run.output()
        assert "fault: " not in run.output()
    assert differences(directory, undisturbed) == []
    assert stamp_faults(directory) == []


def test_the_same_fault_three_times_ends_with_one_error(pictures: Path, tmp_path: Path) -> None:
    directory = tmp_path / "run"
    never = "experiment_manager.checkpoint_period_s=1e9"
    with SupervisedRun(small_run(pictures, N_TRAINING, *SETTINGS, never), directory) as run:
        killed: set[int] = set()
        for _ in range(3):
            assert run.wait_until(
                lambda: run.place() == 0 and not killed & {run.nodes().get("vergence_rl", -1)},
                "another life of the node",
            )
            assert run.wait_until(lambda: "vergence_rl" in run.nodes(), "the node")
            killed.add(run.nodes()["vergence_rl"])
            assert run.signal_node("vergence_rl", signal.SIGKILL)
        assert run.wait() == 3, run.output()
        output = run.output()
    error = "error: the same fault 3 times after episode 0: vergence_rl was killed by SIGKILL"
    assert output.count("error: ") == 1
    assert error in output
    assert is_intact(directory)


def test_two_runs_side_by_side_do_not_see_each_other(
    line: list[str], undisturbed: Path, tmp_path: Path
) -> None:
    with SupervisedRun(line, tmp_path / "a") as a, SupervisedRun(line, tmp_path / "b") as b:
        assert (a.wait(), b.wait()) == (0, 0), a.output() + b.output()
        assert "fault" not in a.output() + b.output()
    for name in ("a", "b"):
        assert differences(tmp_path / name, undisturbed) == []
