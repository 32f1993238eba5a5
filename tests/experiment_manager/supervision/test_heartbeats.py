"""Signs of life as a process passes them on that may itself hang or die; here it is a shell."""

import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import IO

import pytest

from experiment_manager.supervision import heartbeats
from experiment_manager.supervision.fork_server import ForkServer, NodeProcess
from experiment_manager.supervision.heartbeats import Heartbeats


class Shells(ForkServer):
    """Starts a shell with a script, whatever is asked for."""

    def __init__(self, script: str) -> None:
        super().__init__(())
        self.script = script
        self.shells: dict[int, subprocess.Popen[bytes]] = {}

    def start(
        self, package: str, arguments: Sequence[str], domain: int, log: IO[bytes]
    ) -> NodeProcess:
        shell = subprocess.Popen(["sh", "-c", self.script], stdout=log, stderr=log)
        self.shells[shell.pid] = shell
        return NodeProcess(self, shell.pid)

    def exit_code(self, process_id: int) -> int | None:
        code = self.shells[process_id].poll()
        if code is not None:
            self.codes[process_id] = code
        return code


def _fault(listening: Heartbeats) -> str:
    while (fault := listening.wait()) is None:
        pass
    return fault


def test_who_is_heard_is_known() -> None:
    shells = Shells("echo supervisor; printf 'eye_'; echo plant; exec sleep 600")
    with Heartbeats(shells, 1, ["eye_plant", "sparse_coder"]) as listening:
        while not listening.heard >= {"supervisor", "eye_plant"}:
            assert listening.wait() is None
    assert listening.heard == {"supervisor", "eye_plant"}
    assert shells.codes.keys() == shells.shells.keys()


def test_its_own_node_may_die() -> None:
    shells = Shells("echo supervisor; echo 'RCLError: no thread' >&2; exit 1")
    with Heartbeats(shells, 1) as listening:
        assert _fault(listening) == "the supervisor's own node ended: RCLError: no thread"


def test_its_own_node_may_hang_deaf_to_signals(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(heartbeats, "START_LIMIT_S", 0.0)
    port = Path("/dev/shm/fastrtps_port7000")
    monkeypatch.setattr(heartbeats, "unfinished_ports", lambda: {port: 1})
    with Heartbeats(Shells("trap '' TERM; exec sleep 600"), 1, []) as listening:
        assert _fault(listening) == f"supervisor does not respond; {port} was left unfinished"
