"""Threads on two cores: in a process of its own, whose cores are then its own affair."""

import errno
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from lockstep.machine import cores
from tests.patience import PATIENCE_S
from tests.refusing import refusing

PROGRAM = """
import json, os, sys, threading
from lockstep.machine.cores import share_two_cores

cores = set(json.loads(sys.argv[1]))
os.sched_setaffinity(0, cores)
stop = threading.Event()
thread = threading.Thread(target=stop.wait)
thread.start()
share_two_cores(int(sys.argv[2]), gives_way=sys.argv[3] == "True")
ids = {"main": 0, "other": thread.native_id}
found = {name: sorted(os.sched_getaffinity(i)) for name, i in ids.items()}
policies = {os.sched_getscheduler(i) for i in ids.values()}
print(json.dumps({"cores": found, "batch": policies == {os.SCHED_BATCH}}))
stop.set()
"""
AVAILABLE = sorted(os.sched_getaffinity(0))


def shared(available: list[int], i_core: int, *, gives_way: bool = False) -> dict[str, Any]:
    """Return the cores of each thread of a process that has these cores, and whether all wait."""
    command = [sys.executable, "-c", PROGRAM, json.dumps(available), str(i_core), str(gives_way)]
    found = subprocess.run(command, capture_output=True, text=True, check=True, timeout=PATIENCE_S)
    return dict(json.loads(found.stdout))


@pytest.mark.skipif(len(AVAILABLE) < 2, reason="one core only")
@pytest.mark.parametrize("gives_way", [False, True])
@pytest.mark.parametrize("i_core", [0, 1])
def test_of_two_cores_a_process_keeps_to_one(i_core, gives_way) -> None:
    two = AVAILABLE[:2]
    mine = [two[i_core]]
    found = shared(two, i_core, gives_way=gives_way)
    assert found == {"cores": {"main": mine, "other": mine}, "batch": gives_way}


def test_any_other_number_of_cores_is_left_to_the_system() -> None:
    others = AVAILABLE if len(AVAILABLE) != 2 else AVAILABLE[:1]
    found = shared(others, 1 % len(others), gives_way=True)
    assert set(map(tuple, found["cores"].values())) == {tuple(others)}
    assert not found["batch"]


@pytest.mark.parametrize("number", [errno.EINVAL, errno.EPERM, errno.ENOSYS, errno.ESRCH])
@pytest.mark.parametrize("call", ["sched_setaffinity", "sched_getscheduler", "sched_setscheduler"])
def test_what_a_sandbox_refuses_is_left_out(monkeypatch, call: str, number: int) -> None:
    done = []
    monkeypatch.setattr(cores.os, "sched_getaffinity", lambda _: {0, 1})
    monkeypatch.setattr(cores.os, "sched_getscheduler", lambda _: os.SCHED_OTHER)
    for name in ("sched_setaffinity", "sched_setscheduler"):
        monkeypatch.setattr(cores.os, name, lambda *_, name=name: done.append(name))
    monkeypatch.setattr(cores.os, call, refusing(number))
    cores.share_two_cores(0, gives_way=True)
    assert "sched_setaffinity" in done or call == "sched_setaffinity"


def test_without_knowing_the_cores_nothing_is_done(monkeypatch) -> None:
    for name in ("sched_getaffinity", "sched_setaffinity"):
        monkeypatch.setattr(cores.os, name, refusing(errno.ENOSYS))
    cores.share_two_cores(0, gives_way=True)


def test_without_proc_nothing_is_done(monkeypatch, tmp_path: Path) -> None:
    monkeypatch.setattr(cores, "_TASKS", tmp_path / "nowhere")
    monkeypatch.setattr(cores.os, "sched_getaffinity", lambda _: {0, 1})
    monkeypatch.setattr(cores.os, "sched_setaffinity", refusing(errno.EPERM))
    cores.share_two_cores(0, gives_way=True)
