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


def test_mean_and_variance_are_those_of_all_observations() -> None:
    observations = np.random.default_rng(0).standard_normal((200, 3)) * [1.0, 1e-3, 50.0] + 7.0
    statistics = after(observations)
    assert statistics.count == 200
    np.testing.assert_allclose(statistics.mean, observations.mean(axis=0))
    np.testing.assert_allclose(statistics.squared_deviation / 199, observations.var(axis=0, ddof=1))


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


def test_statistics_are_not_changed_in_place() -> None:
    statistics = empty_statistics(2, 0.0)
    updated_statistics(statistics, np.array([1.0, 2.0]))
    assert statistics.count == 0
    np.testing.assert_array_equal(statistics.mean, 0.0)
    np.testing.assert_array_equal(statistics.squared_deviation, 0.0)
