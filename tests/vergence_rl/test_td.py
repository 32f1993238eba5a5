import numpy as np
import pytest

from vergence_rl.td import critic_step, declining_rate, td_error, td_variance, value


def test_td_error() -> None:
    assert td_error(r_t=-0.5, discount=0.3, v_t=2.0, v_tm1=1.0) == pytest.approx(-0.9)


def test_td_variance() -> None:
    assert td_variance(1.0, 3.0, 0.001) == pytest.approx(0.999 + 0.009)


def test_value() -> None:
    assert value(np.array([1.0, -2.0, 0.5]), np.array([3.0, 1.0, 2.0])) == pytest.approx(2.0)


def test_critic_step() -> None:
    got = critic_step(np.array([1.0, -2.0]), np.array([0.5, 0.0]), 2.0, 0.75)
    np.testing.assert_allclose(got, [1.75, -2.0])


def test_critic_step_lowers_the_error_it_was_made_for() -> None:
    weights, state = np.array([0.1, 0.2, -0.3]), np.array([0.5, -1.0, 0.25])
    delta = 1.5 - value(weights, state)
    after = 1.5 - value(critic_step(weights, state, delta, 0.1), state)
    assert after == pytest.approx(delta * (1 - 0.1 * state @ state))


@pytest.mark.parametrize(("now", "rate"), [(0, 0.5), (250, 0.375), (1000, 0.0), (1001, 0.0)])
def test_rate_declines_linearly_to_0(now: int, rate: float) -> None:
    assert declining_rate(0.5, now, 1000) == pytest.approx(rate)
