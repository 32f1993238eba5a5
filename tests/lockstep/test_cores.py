"""Threads on two cores: in a process of its own, whose cores are then its own affair."""

import json
import os
import subprocess
import sys

import pytest

PROGRAM = """
import json, os, sys, threading
from pathlib import Path
from lockstep.cores import keep_to_core

cores = set(json.loads(sys.argv[1]))
os.sched_setaffinity(0, cores)
stop = threading.Event()
names = ["other", "llvmpipe-0", "llvmpipe-1", "llvmpipe-3"]
ids = {}
def work(name):
    Path(f"/proc/self/task/{threading.get_native_id()}/comm").write_text(name)
    ids[name] = threading.get_native_id()
    ready.release()
    stop.wait()
ready = threading.Semaphore(0)
threads = [threading.Thread(target=work, args=(name,)) for name in names]
for thread in threads:
    thread.start()
    ready.acquire()
keep_to_core(int(sys.argv[2]))
print(json.dumps({n: sorted(os.sched_getaffinity(i)) for n, i in {**ids, "main": 0}.items()}))
stop.set()
"""
AVAILABLE = sorted(os.sched_getaffinity(0))


def threads_of(cores: list[int], i_core: int) -> dict[str, list[int]]:
    """Return the cores of each thread of a process that has these cores, and keeps to one."""
    command = [sys.executable, "-c", PROGRAM, json.dumps(cores), str(i_core)]
    found = subprocess.run(command, capture_output=True, text=True, check=True)
    return dict(json.loads(found.stdout))


@pytest.mark.skipif(len(AVAILABLE) < 2, reason="one core only")
@pytest.mark.parametrize("i_core", [0, 1])
def test_of_two_cores_a_process_keeps_to_one_and_draws_on_both(i_core: int) -> None:
    cores = AVAILABLE[:2]
    mine = [cores[i_core]]
    drawing = {f"llvmpipe-{i}": [cores[i % 2]] for i in (0, 1, 3)}
    assert threads_of(cores, i_core) == {"main": mine, "other": mine, **drawing}


def test_any_other_number_of_cores_is_left_to_the_system() -> None:
    cores = AVAILABLE if len(AVAILABLE) != 2 else AVAILABLE[:1]
    assert set(map(tuple, threads_of(cores, 1 % len(cores)).values())) == {tuple(cores)}
