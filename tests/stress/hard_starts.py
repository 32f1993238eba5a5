"""Runs whose nodes are killed, or short of memory, while they start."""

import os
import resource
import signal
from functools import partial
from pathlib import Path

import numpy as np
import psutil

from experiment_manager.supervision.processes import PACKAGES
from tests.stress.disturbed_runs import SUPERVISOR_KILLED, Disturb, Found, runs_with_faults
from tests.stress.supervised_run import SupervisedRun

_SUPERVISOR = "supervisor"
_START_S = 10.0
# The same fault three times without a checkpoint ends a run, as it should.
_MOST_IN_A_RUN = 2
# With the least a node cannot import anything, with the most it finishes.
_LEAST_BYTES, _MOST_BYTES = 100 << 20, 8 << 30


def kill_starts(directory: Path, n_kills: int, seeds: np.random.SeedSequence) -> Found:
    """Kill nodes and supervisors n_kills times in their first ten seconds; compare the numbers."""
    draw = np.random.default_rng(seeds)
    return _disturb_starts(directory, n_kills, partial(kill, known=set(), draw=draw))


def limit_memory(directory: Path, n_limits: int, seeds: np.random.SeedSequence) -> Found:
    """Limit the address space of n_limits nodes as they start; compare the numbers."""
    draw = np.random.default_rng(seeds)
    return _disturb_starts(directory, n_limits, partial(limit, known=set(), draw=draw))


def _disturb_starts(directory: Path, n: int, disturb: Disturb) -> Found:
    figures, problems = runs_with_faults(directory, n, _MOST_IN_A_RUN, disturb)
    logs = [log.read_text(errors="replace") for log in directory.glob("disturbed_*.log")]
    return figures | {"faults": sum(log.count("fault: ") for log in logs)}, problems


def kill(run: SupervisedRun, known: set[int], draw: np.random.Generator) -> str:
    """Kill the supervisor or a node within its first seconds, the first of them above all.

    known: processes of nodes that were disturbed before.
    """
    who = str(draw.choice((_SUPERVISOR, *PACKAGES)))
    delay_s = _START_S * float(draw.random()) ** 2
    if who == _SUPERVISOR:
        if not run.pause(delay_s):
            return ""
        run.kill()
        return SUPERVISOR_KILLED
    node = _next_node(run, who, known)
    if node is None or not run.pause(delay_s):
        return ""
    try:
        os.kill(node, signal.SIGKILL)
    except ProcessLookupError:
        return ""
    return f"{who} killed"


def limit(run: SupervisedRun, known: set[int], draw: np.random.Generator) -> str:
    """Limit the address space of a node that has just been started; known: see `kill`."""
    who = str(draw.choice(PACKAGES))
    most = int(np.exp(draw.uniform(np.log(_LEAST_BYTES), np.log(_MOST_BYTES))))
    node = _next_node(run, who, known)
    if node is None:
        return ""
    try:
        psutil.Process(node).rlimit(resource.RLIMIT_AS, (most, most))
    except psutil.NoSuchProcess:
        return ""
    return f"{who} limited"


def _next_node(run: SupervisedRun, who: str, known: set[int]) -> int | None:
    """Wait for a process of a node that is not known, and know it; None when the run ends first."""
    if not run.wait_until(lambda: run.nodes().get(who) not in (None, *known), f"another {who}"):
        return None
    node = run.nodes().get(who)
    known |= {node} if node is not None else set()
    return node
