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


def flatness(samples: Sequence[Sample]) -> tuple[float, float]:
    """Return how the last tenth of the iterations compares with the first: (rate, work).

    rate: iterations per second, last over first; 1.0 is flat, less is slower. work: processor time
    per iteration, first over last; 1.0 is flat, less is more work. Between samples, time and work
    are interpolated. On a machine with other work to do, rate wavers and work does less.
    """
    first, last = _ends(samples)
    n = np.array([sample.n_iterations for sample in samples], dtype=np.float64)
    span = _TENTH * (last.n_iterations - first.n_iterations)
    edges = (n[0], n[0] + span, n[-1] - span, n[-1])

    def last_over_first(values: list[float]) -> float:
        at = np.interp(edges, n, values)
        return float((at[3] - at[2]) / (at[1] - at[0]))

    seconds = last_over_first([sample.time_s for sample in samples])
    work = last_over_first([sum(sample.cpu_s.values()) for sample in samples])
    return 1.0 / seconds, 1.0 / work


def _ends(samples: Sequence[Sample]) -> tuple[Sample, Sample]:
    if len(samples) < 2 or samples[-1].n_iterations <= samples[0].n_iterations:
        raise InputError(f"expected samples of a graph that goes on, got {len(samples)}")
    return samples[0], samples[-1]
