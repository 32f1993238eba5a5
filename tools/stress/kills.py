"""Nodes that are killed or stopped while they start or work, and supervisors that are killed."""

import signal
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from experiment_manager.nodes import NODES
from tests.command_lines import set_words
from tests.supervised_run import SupervisedRun, differences, n_messages, stamp_faults

LINE = [
    *("--profile", "paper", "--iterations", "2000", "--tests", "0"),
    *set_words(
        {
            "eye_plant.stimuli.size_px": 64,
            "eye_plant.stimuli.n_training": 3,
            "eye_plant.stimuli.n_test": 1,
            "experiment_manager.test_distances_m": [1.0],
            "experiment_manager.least_start_error_deg": 0,
            "experiment_manager.checkpoint_period_s": 1.0,
            "task.n_bases": 32,
        }
    ),
]
# Longest time from one disturbance to the next: starting, catching up and working all get some.
_LONGEST_PAUSE_S = 12.0
# A third one might look like the first two, and that ends a run, as it should.
_MOST_AT_PLACE = 2
_SUPERVISOR_KILLED = "supervisor killed"


def kill(directory: Path, n_kills: int, seed: int) -> tuple[dict[str, Any], list[str]]:
    """Kill or stop nodes, and sometimes the supervisor, n_kills times; compare the numbers.

    A run whose supervisor was killed is resumed. Returns figures, and what went wrong. Raises
    RuntimeError when the undisturbed run, in one process, fails.
    """
    reference = directory / "undisturbed"
    with SupervisedRun(LINE, reference, in_process=True) as undisturbed:
        if undisturbed.wait() != 0:
            raise RuntimeError(f"the undisturbed run failed: {undisturbed.output()}")
    draw, done = np.random.default_rng(seed), Counter[str]()
    problems: list[str] = []
    n_runs = 0
    while done.total() < n_kills and not problems:
        run = directory / f"disturbed_{n_runs}"
        n_runs += 1
        code, output = _disturbed_run(run, n_kills, draw, done)
        if code != 0:
            problems.append(f"{run.name} ended with exit code {code}:\n{output}")
        else:
            problems += differences(run, reference) + stamp_faults(run)
        print(f"run {n_runs}: {done.total()} of {n_kills}, {problems or 'all held'}", flush=True)
    compared = {"runs": n_runs, "messages_compared": n_runs * n_messages(reference)}
    return {
        "disturbances": done.total(),
        "by_kind": dict(sorted(done.items())),
    } | compared, problems


def _disturbed_run(
    directory: Path, n_kills: int, draw: np.random.Generator, done: Counter[str]
) -> tuple[int, str]:
    """Make one run, disturbed until n_kills are done; return its exit code and what it said."""
    done_at, resume = Counter[int](), False
    while True:
        with SupervisedRun(LINE, directory, resume=resume) as run:
            what = ""
            while done.total() < n_kills and run.process.poll() is None:
                what = disturb(run, draw, done_at)
                done.update([what] if what else [])
            if what != _SUPERVISOR_KILLED:
                return run.wait(), run.output()
        resume = True


def disturb(run: SupervisedRun, draw: np.random.Generator, done_at: Counter[int]) -> str:
    """Kill or stop somebody after a while; return what was done, "" when nothing could be.

    done_at: disturbances since each checkpoint of the run.
    """
    if not run.pause(float(draw.uniform(0.0, _LONGEST_PAUSE_S))):
        return ""
    place = run.place()
    if draw.random() < 0.1 and place >= 0:
        done_at[place] += 1
        run.kill()
        return _SUPERVISOR_KILLED
    package = str(draw.choice(NODES))
    number = signal.SIGSTOP if draw.random() < 0.2 else signal.SIGKILL
    if place < 0 or done_at[place]:
        # Perhaps it is still starting. To find out that it hangs would take two minutes.
        number = signal.SIGKILL
    if done_at[place] >= _MOST_AT_PLACE or not run.signal_node(package, number):
        return ""
    done_at[place] += 1
    return f"{package} {'stopped' if number == signal.SIGSTOP else 'killed'}"
