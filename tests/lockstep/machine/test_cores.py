"""Threads on two cores: in a process of its own, whose cores are then its own affair."""

import json
import os
import subprocess
import sys
from typing import Any

import pytest

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


def shared(cores: list[int], i_core: int, *, gives_way: bool = False) -> dict[str, Any]:
    """Return the cores of each thread of a process that has these cores, and whether all wait."""
    command = [sys.executable, "-c", PROGRAM, json.dumps(cores), str(i_core), str(gives_way)]
    found = subprocess.run(command, capture_output=True, text=True, check=True)
    return dict(json.loads(found.stdout))


@pytest.mark.skipif(len(AVAILABLE) < 2, reason="one core only")
@pytest.mark.parametrize("gives_way", [False, True])
@pytest.mark.parametrize("i_core", [0, 1])
def test_of_two_cores_a_process_keeps_to_one(i_core, gives_way) -> None:
    cores = AVAILABLE[:2]
    mine = [cores[i_core]]
    found = shared(cores, i_core, gives_way=gives_way)
    assert found == {"cores": {"main": mine, "other": mine}, "batch": gives_way}


def test_any_other_number_of_cores_is_left_to_the_system() -> None:
    cores = AVAILABLE if len(AVAILABLE) != 2 else AVAILABLE[:1]
    found = shared(cores, 1 % len(cores), gives_way=True)
    assert set(map(tuple, found["cores"].values())) == {tuple(cores)}
    assert not found["batch"]
