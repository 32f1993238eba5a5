"""Nodes that die or hang: the run rolls back, and ends with the numbers of an undisturbed one.

Beside it runs one whose clock jumps: neither is disturbed by the other.
"""

import signal
from collections.abc import Callable
from pathlib import Path

import pytest

from experiment_manager.nodes import NODES
from tests.loop_contract import assert_as_the_loop, run_line
from tests.supervised_run import SupervisedRun, is_alive

pytestmark = pytest.mark.graph


def _beyond(run: SupervisedRun, n_episodes: int) -> Callable[[], bool]:
    """Return whether a checkpoint beyond so many episodes is there, and the bag goes on."""
    return lambda: run.place() >= n_episodes and len(run.nodes()) == len(NODES)


def _beyond_now(run: SupervisedRun) -> Callable[[], bool]:
    place = max(run.place(), 0)
    return lambda: run.place() > place


def _wait_for_rollback(run: SupervisedRun) -> None:
    """Wait until none of the nodes of now is left."""
    nodes = run.nodes().values()
    assert run.wait_until(lambda: not any(is_alive(i) for i in nodes), "the roll-back")


def _recording(run: SupervisedRun) -> Callable[[], bool]:
    n_before = len(list((run.directory / "bag").glob("*.mcap")))
    return lambda: len(list((run.directory / "bag").glob("*.mcap"))) > n_before


# The clock of every Python of the run jumps by the seconds in a file, as soon as there are any.
# Whoever has looked at it then leaves a note.
CLOCK = """
import os, pathlib, time

_now, _now_ns = time.time, time.time_ns
_folder = pathlib.Path(os.environ["CLOCK_FOLDER"])

def _jump():
    try:
        seconds = float((_folder / "jump").read_text() or 0.0)
    except FileNotFoundError:
        return 0.0
    (_folder / f"seen_by_{os.getpid()}").touch()
    return seconds

time.time = lambda: _now() + _jump()
time.time_ns = lambda: _now_ns() + int(_jump() * 1e9)
"""


def _jump(run: SupervisedRun, folder: Path) -> None:
    """Let the clock jump forth and back, each time after a checkpoint."""
    for seconds in (86400.0, -86400.0):
        assert run.wait_until(_beyond_now(run), "a checkpoint")
        (folder / "jump").write_text(str(seconds))


def test_each_node_killed_once_and_one_stopped_beside_a_clock_that_jumps(pictures, tmp_path):
    line, directory, other = run_line(pictures), tmp_path / "run", tmp_path / "other"
    (tmp_path / "sitecustomize.py").write_text(CLOCK)
    jumping = ("env", f"PYTHONPATH={tmp_path}", f"CLOCK_FOLDER={tmp_path}")
    with (
        SupervisedRun(line, other, prefix=jumping) as beside,
        SupervisedRun(line, directory) as run,
    ):
        # One that is only starting, before there is any checkpoint ...
        assert run.wait_until(lambda: "eye_plant" in run.nodes(), "the first nodes")
        assert run.signal_node("eye_plant", signal.SIGKILL)
        _jump(beside, tmp_path)
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
    assert list(tmp_path.glob("seen_by_*"))
    assert_as_the_loop(other)
