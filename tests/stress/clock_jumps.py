"""Runs whose clock on the wall jumps."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tests.stress.supervised_run import (
    SupervisedRun,
    differences,
    n_messages,
    stamp_faults,
    undisturbed,
)

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


def jump(
    line: Sequence[str], directory: Path, n_jumps: int, draw: np.random.Generator
) -> tuple[dict[str, Any], list[str]]:
    """Let the clock jump n_jumps times amid runs; return the figures and what went wrong."""
    reference = undisturbed(line, directory / "steady")
    jumps_s = draw.uniform(-_FARTHEST_S, _FARTHEST_S, n_jumps).tolist()
    farthest_days = round(max(map(abs, jumps_s)) / _S_PER_DAY)
    problems: list[str] = []
    n_runs = 0
    while jumps_s and not problems:
        folder = directory / f"jumping_{n_runs}"
        folder.mkdir()
        n_runs += 1
        problems = _jumping_run(line, folder, jumps_s, draw)
        problems += differences(folder / "run", reference) + stamp_faults(folder / "run")
    figures = {
        "jumps": n_jumps - len(jumps_s),
        "farthest_days": farthest_days,
        "runs": n_runs,
        "messages_compared": n_runs * n_messages(reference),
    }
    return figures, problems


def _jumping_run(
    line: Sequence[str], folder: Path, jumps_s: list[float], draw: np.random.Generator
) -> list[str]:
    """Make one run, and take the jumps away that it has seen; return what went wrong."""
    with SupervisedRun(line, folder / "run", prefix=jumping_clock(folder)) as run:
        run.wait_until(lambda: run.place() >= 0, "the first checkpoint")
        while jumps_s:
            if not run.pause(float(draw.uniform(0.0, _LONGEST_PAUSE_S))):
                break
            (folder / "jump").write_text(str(jumps_s.pop()))
        code, output = run.wait(), run.output()
    if code != 0 or "fault: " in output:
        return [f"{folder.name} ended with exit code {code}:\n{output}"]
    return [] if [*folder.glob("seen_by_*")] else [f"{folder.name}: nobody looked at its clock"]
