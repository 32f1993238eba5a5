import numpy as np
import pytest

from vergence_rl.cacla.critic import bounded_rate, critic_step, td_error, value
from vergence_rl.learning_rule import td_variance


def test_the_rules_by_hand() -> None:
    assert td_error(r_t=-0.5, discount=0.3, v_t=2.0, v_tm1=1.0) == pytest.approx(-0.9)
    assert td_variance(1.0, 3.0, 0.001) == pytest.approx(0.999 + 0.009)
    assert value(np.array([1.0, -2.0, 0.5]), np.array([3.0, 1.0, 2.0])) == pytest.approx(2.0)
    stepped = critic_step(np.array([1.0, -2.0]), np.array([0.5, 0.0]), 2.0, 0.75)
    np.testing.assert_allclose(stepped, [1.75, -2.0])


def test_a_rate_is_bounded_by_the_energy_of_the_state() -> None:
    assert bounded_rate(0.75, np.array([1.0, 0.5]), 1.0) == 0.75
    assert bounded_rate(0.75, np.array([2.0, 0.0]), 1.0) == 0.25
    assert bounded_rate(0.75, np.zeros(2), 1.0) == 0.75


@pytest.mark.parametrize(("limit", "diverges"), [(1.0, False), (1e9, True)])
def test_a_lasting_state_far_out_makes_an_unbounded_critic_diverge(limit, diverges) -> None:
    # K17's rates: each step multiplies V's error by 1 - alpha |s|^2 (1 - gamma) = -1.6.
    state, weights = np.array([2.0, 1.0]), np.zeros(2)
    for _ in range(50):
        v = value(weights, state)
        delta = td_error(-0.2, 0.3, v, v)
        weights = critic_step(weights, state, delta, bounded_rate(0.75, state, limit))
    found = abs(value(weights, state) + 0.2 / 0.7)
    assert found > 1e6 if diverges else found < 1e-9
