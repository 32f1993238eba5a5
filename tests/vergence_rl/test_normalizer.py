import numpy as np
import pytest
from numpy.typing import NDArray

from vergence_rl.normalizer import (
    RunningStatistics,
    empty_statistics,
    normalized,
    updated_statistics,
)


def after(observations: NDArray[np.float64], squared_deviation: float = 0.0) -> RunningStatistics:
    statistics = empty_statistics(observations.shape[1], squared_deviation)
    for entries in observations:
        statistics = updated_statistics(statistics, entries)
    return statistics


# A start above 0 damps the entries.
@pytest.mark.parametrize("start", [0.0, 1.0])
def test_normalized_is_hand_computed(start: float) -> None:
    statistics = after(np.array([[1.0], [3.0]]), squared_deviation=start)  # mean 2, M2 2 + start
    expected = [0.06 / (2.0 + start) ** 0.5]
    np.testing.assert_allclose(normalized(statistics, np.array([5.0]), 0.02), expected)


@pytest.mark.parametrize("n_observations", [0, 1])
def test_before_the_second_observation_all_entries_give_0(n_observations: int) -> None:
    statistics = after(np.full((n_observations, 2), 4.0), squared_deviation=1.0)
    np.testing.assert_array_equal(normalized(statistics, np.array([9.0, -9.0]), 0.02), 0.0)


def test_an_entry_without_variance_gives_0() -> None:
    statistics = after(np.array([[1.0, 1.0], [1.0, 3.0]]))
    got = normalized(statistics, np.array([8.0, 2.0]), 0.02)
    np.testing.assert_array_equal(got, [0.0, 0.0])
    assert normalized(statistics, np.array([8.0, 3.0]), 0.02)[1] > 0.0
