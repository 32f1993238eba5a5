"""A long run, whose memory must not grow."""

import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import psutil

from experiment_manager.supervision.processes import PACKAGES
from tests.stress.disturbed_runs import Found
from tests.stress.supervised_run import SupervisedRun, memory_mb, n_messages, stamp_faults

_SAMPLE_PERIOD_S = 2.0
# A message or a trial that were kept, of 356,000 and 7,800, would show.
_GROWTH_LIMIT_MB = 8.0


def soak(directory: Path, n_iterations: int, seeds: np.random.SeedSequence) -> Found:
    """Make one long run as the paper has it, tests included; look at its memory and its stamps."""
    seed = int(seeds.generate_state(1)[0])
    line = ["--profile", "paper", "--iterations", str(n_iterations), "--seed", str(seed)]
    samples_mb: dict[str, list[float]] = {package: [] for package in PACKAGES}
    began_s = time.monotonic()
    with SupervisedRun(line, directory / "soak") as run:
        while run.pause(_SAMPLE_PERIOD_S):
            for package, process_id in run.nodes().items():
                try:
                    samples_mb[package].append(memory_mb(process_id))
                except psutil.NoSuchProcess:
                    continue
        code, output = run.wait(), run.output()
    if code != 0:
        return {}, [f"the run ended with exit code {code}:\n{output}"]
    growth_mb = {package: round(_growth(values), 1) for package, values in samples_mb.items()}
    problems = stamp_faults(directory / "soak")
    problems += [
        f"{package} grew by {mb} MB from the second quarter of the run to the last"
        for package, mb in growth_mb.items()
        if mb > _GROWTH_LIMIT_MB
    ]
    if "fault: " in output:
        problems.append(f"faults during the soak:\n{output}")
    figures = {
        "iterations": n_iterations,
        "messages": n_messages(directory / "soak"),
        "duration_s": round(time.monotonic() - began_s),
        "peak_mb": {package: round(max(values), 1) for package, values in samples_mb.items()},
        "growth_mb": growth_mb,
    }
    return figures, problems


def _growth(samples: Sequence[float]) -> float:
    """Return how much more the last quarter of the samples is than the second one."""
    quarter = len(samples) // 4
    if quarter < 1:
        return 0.0
    return float(np.median(samples[-quarter:]) - np.median(samples[quarter : 2 * quarter]))
