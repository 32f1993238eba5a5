"""What a listener saw of a running graph, second by second, and the rates that follow."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lockstep.errors import InputError

_TENTH = 0.1


@dataclass(frozen=True)
class Sample:
    """Iterations answered so far, and what the processes have used for them.

    time_s: steady; cpu_s: of each process, all its threads, by name; machine_cpu_s: of everything
    on the machine.
    """

    time_s: float
    n_iterations: int
    cpu_s: dict[str, float]
    machine_cpu_s: float


@dataclass(frozen=True)
class Tenth:
    """Time and processor time, of all processes, that a tenth of a run's iterations took."""

    duration_s: float
    cpu_s: float


def rate_hz(samples: Sequence[Sample]) -> float:
    """Return iterations per second between the first and the last of two or more samples."""
    first, last = _ends(samples)
    return (last.n_iterations - first.n_iterations) / (last.time_s - first.time_s)


def cpu_ms_per_iteration(samples: Sequence[Sample]) -> dict[str, float]:
    """Return the processor time of each process between the first and the last sample."""
    first, last = _ends(samples)
    n = last.n_iterations - first.n_iterations
    return {name: 1e3 * (last.cpu_s[name] - first.cpu_s[name]) / n for name in last.cpu_s}


def cores_elsewhere(samples: Sequence[Sample]) -> float:
    """Return how many cores other work kept busy between the first and the last sample."""
    first, last = _ends(samples)
    ours_s = sum(last.cpu_s.values()) - sum(first.cpu_s.values())
    all_s = last.machine_cpu_s - first.machine_cpu_s
    return max(0.0, all_s - ours_s) / (last.time_s - first.time_s)


def first_tenth(samples: Sequence[Sample], n_iterations: int) -> Tenth:
    """Return what the first tenth of n_iterations took; samples go on at least that far."""
    first, _ = _ends(samples)
    return _tenth(samples, first.n_iterations, first.n_iterations + _TENTH * n_iterations)


def last_tenth(samples: Sequence[Sample], n_iterations: int) -> Tenth:
    """Return what the last tenth of n_iterations took, the last ones that the samples hold."""
    _, last = _ends(samples)
    return _tenth(samples, last.n_iterations - _TENTH * n_iterations, last.n_iterations)


def _tenth(samples: Sequence[Sample], start: float, end: float) -> Tenth:
    """Between samples, time and work are interpolated."""
    n = [sample.n_iterations for sample in samples]
    seconds = np.interp((start, end), n, [sample.time_s for sample in samples])
    work_s = np.interp((start, end), n, [sum(sample.cpu_s.values()) for sample in samples])
    return Tenth(float(seconds[1] - seconds[0]), float(work_s[1] - work_s[0]))


def flatness(firsts: Sequence[Tenth], lasts: Sequence[Tenth]) -> tuple[list[float], list[float]]:
    """Return how the last tenth of each run compares with the first: (rates, work).

    firsts: of the runs, and of one more run that was started after them; lasts: of the runs. The
    speed of a machine wavers from minute to minute, so each last tenth is held against the mean of
    the first ones before and after it. rates: last over first; 1.0 is flat, less is slower. work:
    processor time per iteration, first over last; 1.0 is flat, less is more work.
    """
    if len(firsts) != len(lasts) + 1:
        raise InputError(f"expected a first tenth more than last ones, got {len(firsts)}")
    around = list(zip(firsts, firsts[1:], lasts, strict=False))
    rates = [(a.duration_s + b.duration_s) / 2.0 / last.duration_s for a, b, last in around]
    work = [(a.cpu_s + b.cpu_s) / 2.0 / last.cpu_s for a, b, last in around]
    return rates, work


def _ends(samples: Sequence[Sample]) -> tuple[Sample, Sample]:
    if len(samples) < 2 or samples[-1].n_iterations <= samples[0].n_iterations:
        raise InputError(f"expected samples of a graph that goes on, got {len(samples)}")
    return samples[0], samples[-1]
