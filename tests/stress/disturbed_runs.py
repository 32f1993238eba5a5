"""Runs that are disturbed until it was often enough, each compared with an undisturbed one."""

import shutil
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

from experiment_manager.run.config_file import CONFIG_FILE
from tests.command_lines import set_words
from tests.stress.supervised_run import SupervisedRun, n_messages, problems_of, undisturbed

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

# The figures of a part of the torture, and what went wrong.
Found = tuple[dict[str, Any], list[str]]
# Disturbs a run once; returns what was done, "" when nothing could be.
Disturb = Callable[[SupervisedRun], str]
SUPERVISOR_KILLED = "supervisor killed"


def compared_runs(
    directory: Path, n: int, done: Counter[str], make_run: Callable[[Path], tuple[int, str]]
) -> Found:
    """Make runs until n disturbances are done, and compare their numbers.

    make_run: makes one in a directory, and counts in done what it does to it; returns its exit code
    and what it said.
    """
    reference = undisturbed(LINE, directory / "undisturbed")
    problems: list[str] = []
    n_runs = 0
    while done.total() < n and not problems:
        run = directory / f"disturbed_{n_runs}"
        n_runs += 1
        problems += problems_of(run, reference, *make_run(run))
        print(f"run {n_runs}: {done.total()} of {n} disturbances, {problems or 'all held'}")
    return {"runs": n_runs, "messages_compared": n_runs * n_messages(reference)}, problems


def runs_with_faults(directory: Path, n: int, most_in_a_run: int, disturb: Disturb) -> Found:
    """Disturb runs n times so that they roll back; a run whose supervisor is killed is resumed."""
    done: Counter[str] = Counter()

    def make_run(run: Path) -> tuple[int, str]:
        return _run_with_faults(run, min(n, done.total() + most_in_a_run), disturb, done)

    figures, problems = compared_runs(directory, n, done, make_run)
    disturbances = {"disturbances": done.total(), "by_kind": dict(sorted(done.items()))}
    return disturbances | figures, problems


def _run_with_faults(
    directory: Path, most: int, disturb: Disturb, done: Counter[str]
) -> tuple[int, str]:
    """Make one run, disturbed until so much is done; return its exit code and what it said."""
    while True:
        resume = (directory / CONFIG_FILE).exists()
        if not resume:  # its supervisor died before there was anything to go on with
            shutil.rmtree(directory, ignore_errors=True)
        with SupervisedRun(LINE, directory, resume=resume) as run:
            what = ""
            while done.total() < most and run.process.poll() is None:
                what = disturb(run)
                done.update([what] if what else [])
            if what != SUPERVISOR_KILLED:
                return run.wait(), run.output()
