import math

import numpy as np
import pytest

from lockstep import InputError
from sparse_coder.matching_pursuit import Selections
from sparse_coder.reward import lambda_by_now, random_reward, reconstruction_error, reward

ERRORS = np.array([0.1, 0.3])


def test_the_error_is_the_share_of_all_patches_energy_that_their_selections_leave() -> None:
    patches = np.array([[3.0, 4.0], [0.0, 5.0]], np.float32)  # of energy 50
    selections = Selections(np.array([[0], [1]], np.int32), np.array([[3.0], [4.0]], np.float32))
    assert reconstruction_error(patches, selections) == pytest.approx(25.0 / 50.0)


def test_energy_is_charged_at_its_price() -> None:
    got = reward(ERRORS, 1.4, 0.035)
    assert got.value == pytest.approx(-0.4 - 0.049)
    assert got.energy_penalty == pytest.approx(0.049)


@pytest.mark.parametrize("rate_w", np.random.default_rng(0).uniform(0.1, 2.0, 20))
def test_reward_and_penalty_make_the_error_to_the_last_bit(rate_w: float) -> None:
    got = reward(ERRORS, rate_w, 0.065)
    assert got.value + got.energy_penalty == -0.4


@pytest.mark.parametrize("rate_w", [math.nan, math.inf, -0.1])
def test_a_bad_metabolic_rate_is_refused(rate_w: float) -> None:
    with pytest.raises(InputError, match="metabolic rate: expected 0 W or more"):
        reward(ERRORS, rate_w, 0.0)


def test_a_price_rises_from_0_or_is_constant() -> None:
    assert [lambda_by_now(0.5, n, 4.0) for n in range(6)] == [0.0, 0.125, 0.25, 0.375, 0.5, 0.5]
    assert lambda_by_now(0.5, 0, 0.0) == 0.5


def test_random_rewards_differ_by_seed_and_time_alone() -> None:
    times = [(n, i) for n in range(30) for i in range(10)]
    drawn = [random_reward(1, *at).value for at in times]
    assert drawn == [random_reward(1, *at).value for at in times]
    assert len({*drawn, *(random_reward(2, *at).value for at in times)}) == 600
    assert -1.0 <= min(drawn) < -0.95
    assert -0.05 < max(drawn) <= 0.0
    assert random_reward(1, 0, 0).energy_penalty == 0.0
