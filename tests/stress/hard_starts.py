"""Runs whose nodes are killed, or short of memory, while they start."""

import os
import resource
import shutil
import signal
from collections import Counter
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from experiment_manager.run.config_file import CONFIG_FILE
from experiment_manager.supervision.processes import PACKAGES
from tests.stress.supervised_run import (
    SupervisedRun,
    are_gone,
    n_messages,
    problems_of,
    undisturbed,
)

_SUPERVISOR = "supervisor"
_START_S = 10.0
# The same fault three times without a checkpoint ends a run, as it should.
_MOST_IN_A_RUN = 2
# More than a node has as it is forked: with the least it cannot begin, with the most it finishes.
_LEAST_BYTES, _MOST_BYTES = 10 << 20, 500 << 20

Figures = tuple[dict[str, Any], list[str]]
# Disturbs a run in whom it has not disturbed before; returns what was done, "" when nothing could.
Disturb = Callable[[SupervisedRun, set[int]], str]


def kill_starts(
    line: Sequence[str], directory: Path, n_kills: int, draw: np.random.Generator
) -> Figures:
    """Kill nodes and supervisors n_kills times in their first ten seconds; compare the numbers."""
    return _disturb_starts(line, directory, n_kills, partial(kill, draw=draw))


def limit_memory(
    line: Sequence[str], directory: Path, n_limits: int, draw: np.random.Generator
) -> Figures:
    """Limit the address space of n_limits nodes as they start; compare the numbers."""
    return _disturb_starts(line, directory, n_limits, partial(limit, draw=draw))


def kill(
    run: SupervisedRun, known: set[int], *, draw: np.random.Generator, longest_s: float = _START_S
) -> str:
    """Kill the supervisor or a node within its first seconds, the first of them above all."""
    who = str(draw.choice((_SUPERVISOR, *PACKAGES)))
    delay_s = longest_s * float(draw.random()) ** 2
    node = run.process.pid if who == _SUPERVISOR else _next_node(run, who, known)
    if node is None or not run.pause(delay_s):
        return ""
    nodes = run.nodes().values()
    try:
        os.kill(node, signal.SIGKILL)
    except ProcessLookupError:
        return ""
    if who == _SUPERVISOR:
        run.process.wait()
        if not are_gone(nodes):
            raise RuntimeError(f"nodes outlive their supervisor: {nodes}")
    return f"{who} killed"


def limit(run: SupervisedRun, known: set[int], *, draw: np.random.Generator) -> str:
    """Limit the address space of a node that has just been forked."""
    who = str(draw.choice(PACKAGES))
    more_bytes = int(np.exp(draw.uniform(np.log(_LEAST_BYTES), np.log(_MOST_BYTES))))
    node = _next_node(run, who, known)
    if node is None:
        return ""
    try:
        pages = int(Path(f"/proc/{node}/statm").read_text().split()[0])
        most = pages * resource.getpagesize() + more_bytes
        resource.prlimit(node, resource.RLIMIT_AS, (most, most))
    except (FileNotFoundError, ProcessLookupError):
        return ""
    return f"{who} limited"


def _next_node(run: SupervisedRun, who: str, known: set[int]) -> int | None:
    """Wait for a process of a node that is not known, and know it; None when the run ends first."""
    if not run.wait_until(lambda: run.nodes().get(who) not in (None, *known), f"another {who}"):
        return None
    node = run.nodes().get(who)
    known |= {node} if node is not None else set()
    return node


def _disturb_starts(line: Sequence[str], directory: Path, n: int, disturb: Disturb) -> Figures:
    reference = undisturbed(line, directory / "undisturbed")
    done: Counter[str] = Counter()
    problems: list[str] = []
    n_runs = n_faults = 0
    while done.total() < n and not problems:
        folder = directory / f"disturbed_{n_runs}"
        n_here = min(n - done.total(), _MOST_IN_A_RUN)
        code, output = _disturbed_run(line, folder, n_here, disturb, done)
        n_runs += 1
        n_faults += output.count("fault: ")
        problems += problems_of(folder, reference, code, output)
        print(f"run {n_runs}: {done.total()} of {n} disturbed starts, {problems or 'all held'}")
    figures = {
        "disturbances": done.total(),
        "by_kind": dict(sorted(done.items())),
        "faults": n_faults,
        "runs": n_runs,
        "messages_compared": n_runs * n_messages(reference),
    }
    return figures, problems


def _disturbed_run(
    line: Sequence[str], folder: Path, n: int, disturb: Disturb, done: Counter[str]
) -> tuple[int, str]:
    """Make one run, resumed when its supervisor dies; return its exit code and what it said."""
    known: set[int] = set()
    most = done.total() + n
    while True:
        resume = (folder / CONFIG_FILE).exists()
        if not resume:  # it died before there was anything to go on with
            shutil.rmtree(folder, ignore_errors=True)
        with SupervisedRun(line, folder, resume=resume) as run:
            what = ""
            while done.total() < most and run.process.poll() is None:
                what = disturb(run, known)
                done.update([what] if what else [])
            if not what.startswith(_SUPERVISOR):
                return run.wait(), run.output()
