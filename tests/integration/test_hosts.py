"""The plant on another machine: the network breaks, and the run ends as if it had not."""

import signal
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest

from experiment_manager.run.config_file import CONFIG_FILE
from tests.loop_contract import N_TRAINING, N_TRIALS, PICTURE_PX, assert_as_the_loop, run_line
from tests.patience import PATIENCE_S
from tests.supervised_run import SupervisedRun, are_gone, is_alive
from tests.two_hosts import NodeOnHost, TwoHosts

pytestmark = pytest.mark.graph

N_PICTURE_BYTES = (N_TRAINING + 20 * N_TRIALS) * 2 * PICTURE_PX**2

_KILLED = "fault: vergence_rl was killed by SIGKILL"


@pytest.fixture
def hosts() -> Iterator[TwoHosts]:
    """Yield two machines with a cable between them."""
    try:
        hosts = TwoHosts()
    except OSError as error:
        pytest.skip(f"two hosts need root, and ip, unshare and nsenter: {error}")
    with hosts:
        yield hosts


def _cut_until_something_is_lost(run: SupervisedRun, hosts: TwoHosts) -> None:
    hosts.cut()
    n_before = hosts.n_lost()
    assert run.wait_until(lambda: hosts.n_lost() > n_before, "a packet that finds no way")


def _break_and_mend(run: SupervisedRun, hosts: TwoHosts, log: Path) -> None:
    """Cut the network twice: once for a while, and once while a node dies."""
    # A cut that is waited out ...
    _cut_until_something_is_lost(run, hosts)
    hosts.heal()
    place = run.place()
    assert run.wait_until(lambda: run.place() > place, "more episodes")
    assert "fault" not in run.output()
    # ... and one during which a node dies: those that follow it begin without a network.
    _cut_until_something_is_lost(run, hosts)
    # After a cut while nodes begin, the supervisor starts all again, and a kill then is no fault.
    while _KILLED not in run.output():
        _kill_the_learner(run, log)
    hosts.heal()


def _kill_the_learner(run: SupervisedRun, log: Path) -> None:
    """Kill it, and wait for the nodes that follow."""
    assert run.wait_until(lambda: "vergence_rl" in run.nodes(), "a learner")
    learner = run.nodes()["vergence_rl"]
    run.signal_node("vergence_rl", signal.SIGKILL)
    assert run.wait_until(lambda: not is_alive(learner), "the roll-back")
    n_waits = log.read_text().count("waiting for episode")
    assert run.wait_until(
        lambda: log.read_text().count("waiting for episode") > n_waits, "the new nodes"
    )


def test_the_plant_on_another_machine_behind_a_network_that_breaks(hosts, pictures, tmp_path):
    directory = tmp_path / "run"
    line = run_line(pictures)
    log = directory / "logs" / "experiment_manager.log"
    start = partial(SupervisedRun, line, directory, elsewhere=("eye_plant",), prefix=hosts.a.prefix)
    with start() as first:
        assert first.wait_until((directory / CONFIG_FILE).exists, "config.yaml")
        with NodeOnHost(hosts.b, "eye_plant", directory / CONFIG_FILE):
            assert first.wait_until(lambda: first.place() >= 3, "some episodes")
            # The plant outlives its run, and is there for the one that goes on with it.
            nodes = first.nodes().values()
            first.process.kill()
            first.process.wait(PATIENCE_S)
            assert are_gone(nodes)
            with start(resume=True) as run:
                place = run.place()
                assert run.wait_until(lambda: run.place() > place, "more episodes")
                _break_and_mend(run, hosts, log)
                assert run.wait() == 0, run.output()
                output = run.output()
    assert "eye_plant is awaited; on its machine, with a copy of " in output
    assert output.count("fault: ") == output.count(_KILLED) == 1
    assert "the network is back: starting the nodes again" in output
    assert_as_the_loop(directory)
    # The pictures came over the cable, not through shared memory.
    assert hosts.n_bytes() > N_PICTURE_BYTES
