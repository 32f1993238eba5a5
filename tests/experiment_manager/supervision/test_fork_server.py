"""Forked nodes: each is what a process of its own would be, and ends when it should."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import psutil
import pytest

from tests.patience import PATIENCE_S

# A package whose node says what it finds, and then does as it is told.
NODE = """
import os, signal, sys, time

def main():
    print("out", sys.argv, os.environ["ROS_DOMAIN_ID"])
    print("err", signal.getsignal(signal.SIGINT) is signal.default_int_handler, file=sys.stderr)
    if sys.argv[1] == "raise":
        raise ValueError("no such thing")
    if sys.argv[1] == "exit":
        sys.exit(int(sys.argv[2]))
    print("to the terminal", file=os.fdopen(int(os.environ["ABV_TERMINAL_FD"]), "w"), flush=True)
    time.sleep(600)
"""
STARTER = """
import sys
from pathlib import Path
from experiment_manager.supervision.fork_server import ForkServer

with ForkServer(["infant"]) as fork_server:
    started = []
    for line in sys.stdin:
        command, *words = line.split()
        if command == "start":
            with Path("infant.log").open("ab") as log:
                started.append(fork_server.start("infant", words, 17, log))
            print(started[-1].process_id, flush=True)
        else:
            while (code := started[int(words[0])].exit_code()) is None:
                pass
            print(code, flush=True)
"""


class Starter:
    """A process with a fork server, that does as it is told."""

    def __init__(self, directory: Path) -> None:
        package = directory / "infant"
        package.mkdir()
        (package / "__init__.py").write_text("")
        (package / "node.py").write_text(NODE)
        self.log = directory / "infant.log"
        self.process = subprocess.Popen(
            [sys.executable, "-c", STARTER],
            cwd=directory,
            env=os.environ | {"PYTHONPATH": str(directory)},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

    def tell(self, line: str) -> int:
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        print(line, file=self.process.stdin, flush=True)
        return int(self.process.stdout.readline())


@pytest.fixture
def starter(tmp_path: Path) -> object:
    """Give a process with a fork server, killed afterwards."""
    starter = Starter(tmp_path)
    yield starter
    starter.process.kill()
    starter.process.communicate()


def wait_until(condition: Callable[[], bool]) -> None:
    end_s = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < end_s
        time.sleep(0.01)


def test_a_node_gets_its_arguments_domain_and_log(starter: Starter) -> None:
    starter.tell("start exit 0")
    assert starter.tell("code 0") == 0
    said = starter.log.read_text().splitlines()
    assert sorted(said) == ["err True", "out ['infant.node', 'exit', '0'] 17"]


def test_how_nodes_end_is_told_of_each(starter: Starter) -> None:
    starter.tell("start exit 7")
    killed = starter.tell("start sleep")
    starter.tell("start raise")
    os.kill(killed, signal.SIGKILL)
    assert [starter.tell(f"code {i}") for i in range(3)] == [7, -signal.SIGKILL, 1]
    assert starter.log.read_text().splitlines()[-1] == "ValueError: no such thing"


def test_a_node_is_found_under_its_name_and_reaches_the_terminal(starter: Starter) -> None:
    node = psutil.Process(starter.tell("start sleep"))
    assert starter.process.stderr is not None
    assert starter.process.stderr.readline() == "to the terminal\n"
    assert node.name() == "infant"
    assert node.cmdline()[:4] == ["python", "-m", "infant.node", "sleep"]
    assert os.getsid(node.pid) == node.pid


def test_a_node_that_cannot_be_imported_says_so_itself(starter: Starter) -> None:
    (starter.log.parent / "infant" / "node.py").write_text("import nowhere_at_all\n")
    starter.tell("start exit 0")
    assert starter.tell("code 0") == 1
    assert "No module named 'nowhere_at_all'" in starter.log.read_text()


def test_all_nodes_die_with_whoever_wanted_them(starter: Starter) -> None:
    nodes = [psutil.Process(starter.tell("start sleep")) for _ in range(2)]
    starter.process.kill()
    starter.process.wait()
    wait_until(lambda: not any(_lives(node) for node in nodes))


def test_without_the_fork_server_all_its_nodes_count_as_killed(starter: Starter) -> None:
    node = psutil.Process(starter.tell("start sleep"))
    os.kill(node.ppid(), signal.SIGKILL)
    assert starter.tell("code 0") == -signal.SIGKILL
    wait_until(lambda: not _lives(node))
    with pytest.raises(ValueError, match="invalid literal"):
        starter.tell("start sleep")
    assert "ConnectionError: the process that starts the nodes" in starter.process.communicate()[1]


def _lives(process: psutil.Process) -> bool:
    try:
        return process.status() != psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return False
