"""Intervals over seeds, against tables of t and by simulation."""

import numpy as np
import pytest

from experiment_manager.measures.seeds import over_seeds
from lockstep import InputError


def test_an_interval_by_hand() -> None:
    mean, half_width = over_seeds([1.0, 2.0, 3.0, 4.0, 5.0])
    # t of 4 degrees of freedom at 0.975 is 2.776, the standard deviation sqrt(2.5).
    assert mean == 3.0
    assert half_width == pytest.approx(2.776 * np.sqrt(2.5 / 5), rel=1e-3)


def test_each_entry_has_its_own_interval() -> None:
    values = np.array([[1.0, 5.0], [3.0, 5.0]])
    mean, half_width = over_seeds(values)
    assert mean.tolist() == [2.0, 5.0]
    assert half_width == pytest.approx([12.706, 0.0], rel=1e-4)


def test_one_seed_has_no_interval_and_none_is_refused() -> None:
    assert np.isnan(over_seeds([0.5])[1])
    with pytest.raises(InputError, match="one seed or more"):
        over_seeds([])


def test_95_of_100_intervals_hold_the_mean() -> None:
    draws = np.random.default_rng(0).normal(0.3, 0.1, (3, 20_000))
    mean, half_width = over_seeds(draws)
    assert np.mean(np.abs(mean - 0.3) < half_width) == pytest.approx(0.95, abs=0.005)
