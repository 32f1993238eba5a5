"""Who is disturbed while a run starts, with processes that only sleep in the place of nodes."""

import resource
import signal
import subprocess
from collections.abc import Iterator
from unittest import mock

import pytest

from experiment_manager.supervision.processes import PACKAGES
from tests.stress.hard_starts import kill, limit
from tests.stress.supervised_run import SupervisedRun


def _sleep() -> "subprocess.Popen[str]":
    return subprocess.Popen(["sleep", "600"], text=True)


class SleepingRun(SupervisedRun):
    """A supervisor and nodes that do nothing; who has ended is no node any more."""

    def __init__(self) -> None:
        self.process = _sleep()
        self.sleepers = {package: _sleep() for package in PACKAGES}

    def nodes(self) -> dict[str, int]:
        if self.process.poll() is not None:
            self.end_nodes()
        return {name: node.pid for name, node in self.sleepers.items() if node.poll() is None}

    def end_nodes(self) -> None:
        for node in self.sleepers.values():
            node.kill()
            node.wait()


@pytest.fixture
def run() -> Iterator[SleepingRun]:
    run = SleepingRun()
    yield run
    run.process.kill()
    run.process.wait()
    run.end_nodes()


def _drawing(who: str) -> mock.Mock:
    """Return a generator that draws somebody, at once, and some memory."""
    draws = {"choice.return_value": who, "random.return_value": 0.0, "uniform.return_value": 18.0}
    return mock.Mock(**draws)


def test_a_node_is_killed_and_it_alone(run: SleepingRun) -> None:
    who = PACKAGES[-1]
    known: set[int] = set()
    assert kill(run, known, _drawing(who)) == f"{who} killed"
    assert run.sleepers[who].wait() == -signal.SIGKILL
    assert known == {run.sleepers[who].pid}
    assert set(run.nodes()) == set(PACKAGES) - {who}


def test_a_killed_supervisor_takes_its_nodes_with_it(run: SleepingRun) -> None:
    run.end_nodes()
    assert kill(run, set(), _drawing("supervisor")) == "supervisor killed"
    assert run.process.returncode == -signal.SIGKILL


def test_each_node_is_limited_once(run: SleepingRun) -> None:
    who = PACKAGES[0]
    known: set[int] = set()
    assert limit(run, known, _drawing(who)) == f"{who} limited"
    limits = {
        name: resource.prlimit(node, resource.RLIMIT_AS)[0] for name, node in run.nodes().items()
    }
    assert {name for name, most in limits.items() if most != resource.RLIM_INFINITY} == {who}
    # It lives on: there is no other process of that node until the run has ended.
    run.process.kill()
    run.process.wait()
    assert limit(run, known, _drawing(who)) == ""
