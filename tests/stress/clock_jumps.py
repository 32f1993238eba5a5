"""Runs whose clock on the wall jumps."""

from collections import Counter
from pathlib import Path

import numpy as np

from tests.stress.disturbed_runs import LINE, Found, compared_runs
from tests.stress.supervised_run import SupervisedRun

# The clock of every Python of the run jumps by the seconds in a file, as soon as there are any.
# Whoever has looked at it then leaves a note.
CLOCK = """
import os, pathlib, time

_now, _now_ns = time.time, time.time_ns
_folder = pathlib.Path(os.environ["CLOCK_FOLDER"])

def _jump():
    try:
        seconds = float((_folder / "jump").read_text() or 0.0)
    except FileNotFoundError:
        return 0.0
    (_folder / f"seen_by_{os.getpid()}").touch()
    return seconds

time.time = lambda: _now() + _jump()
time.time_ns = lambda: _now_ns() + int(_jump() * 1e9)
"""
_LONGEST_PAUSE_S = 3.0
_FARTHEST_S = 5e7
_S_PER_DAY = 86_400.0


def jumping_clock(folder: Path) -> tuple[str, ...]:
    """Return the prefix of a command whose clock jumps by what is written to `folder`/jump."""
    (folder / "sitecustomize.py").write_text(CLOCK)
    return ("env", f"PYTHONPATH={folder}", f"CLOCK_FOLDER={folder}")


def jump(directory: Path, n_jumps: int, seeds: np.random.SeedSequence) -> Found:
    """Let the clock jump n_jumps times during runs; return the figures and what went wrong."""
    draw = np.random.default_rng(seeds)
    jumps_s = draw.uniform(-_FARTHEST_S, _FARTHEST_S, n_jumps)
    done = Counter[str]()
    problems: list[str] = []

    def make_run(directory: Path) -> tuple[int, str]:
        clock = directory.with_name(f"{directory.name}_clock")
        clock.mkdir()
        with SupervisedRun(LINE, directory, prefix=jumping_clock(clock)) as run:
            run.wait_until(lambda: run.place() >= 0, "the first checkpoint")
            while done.total() < n_jumps:
                if not run.pause(float(draw.uniform(0.0, _LONGEST_PAUSE_S))):
                    break
                (clock / "jump").write_text(str(jumps_s[done.total()]))
                done["jumped"] += 1
            ended = run.wait(), run.output()
        if "fault: " in ended[1]:
            problems.append(f"faults in {directory.name}:\n{ended[1]}")
        if not [*clock.glob("seen_by_*")]:
            problems.append(f"{directory.name}: nobody looked at its clock")
        return ended

    figures, others = compared_runs(directory, n_jumps, done, make_run)
    farthest_days = round(float(np.abs(jumps_s).max()) / _S_PER_DAY)
    return {"jumps": done.total(), "farthest_days": farthest_days} | figures, problems + others
