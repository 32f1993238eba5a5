"""Nodes that die or hang: the run rolls back, and ends with the numbers of an undisturbed one."""

import signal
from collections.abc import Callable

import pytest

from experiment_manager.nodes import NODES
from tests.loop_contract import assert_as_the_loop, run_line
from tests.supervised_run import SupervisedRun, is_alive

pytestmark = pytest.mark.graph


def _beyond(run: SupervisedRun, n_episodes: int) -> Callable[[], bool]:
    """Return whether a checkpoint beyond so many episodes is there, and the bag goes on."""
    return lambda: run.place() >= n_episodes and len(run.nodes()) == len(NODES)


def _wait_for_rollback(run: SupervisedRun) -> None:
    """Wait until none of the nodes of now is left."""
    nodes = run.nodes().values()
    assert run.wait_until(lambda: not any(is_alive(i) for i in nodes), "the roll-back")


def _recording(run: SupervisedRun) -> Callable[[], bool]:
    n_before = len(list((run.directory / "bag").glob("*.mcap")))
    return lambda: len(list((run.directory / "bag").glob("*.mcap"))) > n_before


def test_each_node_killed_once_and_one_stopped_beside_another_run(pictures, tmp_path) -> None:
    line, directory, other = run_line(pictures), tmp_path / "run", tmp_path / "other"
    with SupervisedRun(line, directory) as run, SupervisedRun(line, other) as beside:
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
        assert beside.wait() == 0, beside.output()
        assert "fault" not in beside.output()
    for package in NODES:
        assert output.count(f"fault: {package} was killed by SIGKILL") == 1, output
    # Whoever misses the hanging node first says so: the manager, or during a checkpoint we do.
    hang = ("ended: no message for 8 s; missing: ", "fault: sparse_coder does not respond")
    assert sum(output.count(text) for text in hang) == 1, output
    assert_as_the_loop(directory)
    assert_as_the_loop(other)
