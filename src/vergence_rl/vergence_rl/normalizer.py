"""Online normalisation of the state's entries by Welford's rule (Welford 1962)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class RunningStatistics:
    """count: observations seen; mean, squared_deviation: (n_entries,) mean and M2 of each entry."""

    count: int
    mean: NDArray[np.float64]
    squared_deviation: NDArray[np.float64]


def empty_statistics(n_entries: int, squared_deviation: float) -> RunningStatistics:
    """Return the statistics before the first observation; M2 starts at squared_deviation."""
    return RunningStatistics(0, np.zeros(n_entries), np.full(n_entries, squared_deviation))


def updated_statistics(
    statistics: RunningStatistics, entries: NDArray[np.float64]
) -> RunningStatistics:
    """Return the statistics with one more observation, x (n_entries,).

    n <- n + 1; d = x - mean; mean <- mean + d / n; M2 <- M2 + d (x - mean)  (Welford 1962)
    """
    count = statistics.count + 1
    deviation = entries - statistics.mean
    mean = statistics.mean + deviation / count
    squared_deviation = statistics.squared_deviation + deviation * (entries - mean)
    return RunningStatistics(count, mean, squared_deviation)


def normalized(
    statistics: RunningStatistics, entries: NDArray[np.float64], standard_deviation: float
) -> NDArray[np.float64]:
    """Return sd * (x - mean) / sqrt(M2 / (n - 1)), (n_entries,).

    An entry without variance gives 0, and so do all before the second observation.
    """
    if statistics.count < 2:
        return np.zeros_like(entries)
    root = np.sqrt(statistics.squared_deviation / (statistics.count - 1))
    deviation = standard_deviation * (entries - statistics.mean)
    return np.divide(deviation, root, out=np.zeros_like(entries), where=root > 0.0)
