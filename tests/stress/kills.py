"""Nodes that are killed or stopped while they work, and supervisors that are killed."""

import signal
from collections import Counter
from functools import partial
from pathlib import Path

import numpy as np

from experiment_manager.supervision.processes import PACKAGES
from tests.stress.disturbed_runs import SUPERVISOR_KILLED, Found, runs_with_faults
from tests.stress.supervised_run import SupervisedRun

# Longest time from one disturbance to the next: starting, catching up and working all get some.
_LONGEST_PAUSE_S = 12.0
# A third one might look like the first two, and that ends a run, as it should.
_MOST_AT_PLACE = 2


def kill_at_work(directory: Path, n_kills: int, seeds: np.random.SeedSequence) -> Found:
    """Kill or stop nodes, and sometimes the supervisor, n_kills times; compare the numbers."""
    disturb = partial(_disturb, draw=np.random.default_rng(seeds), done_at=Counter())
    return runs_with_faults(directory, n_kills, n_kills, disturb)


def _disturb(
    run: SupervisedRun, draw: np.random.Generator, done_at: Counter[tuple[Path, int]]
) -> str:
    """Kill or stop somebody; done_at: disturbances since each checkpoint of each run."""
    if not run.pause(float(draw.uniform(0.0, _LONGEST_PAUSE_S))):
        return ""
    place = run.place()
    here = run.directory, place
    if draw.random() < 0.1 and place >= 0:
        done_at[here] += 1
        run.kill()
        return SUPERVISOR_KILLED
    package = PACKAGES[int(draw.integers(len(PACKAGES)))]
    number = signal.SIGSTOP if draw.random() < 0.2 else signal.SIGKILL
    if place < 0 or done_at[here]:
        # Perhaps it is still starting. To find out that it hangs would take two minutes.
        number = signal.SIGKILL
    if done_at[here] >= _MOST_AT_PLACE or not run.signal_node(package, number):
        return ""
    done_at[here] += 1
    return f"{package} {'stopped' if number == signal.SIGSTOP else 'killed'}"
