import math

import numpy as np
import pytest

from vergence_rl.cacla.actor import (
    ActorOutput,
    ActorWeights,
    actor,
    actor_rate,
    actor_step,
    n_updates,
)


def test_actor_is_hand_computed() -> None:
    weights = ActorWeights(
        hidden=np.array([[1.0, 0.0], [0.0, -2.0]]), output=np.array([[1.0, 1.0], [0.0, 3.0]])
    )
    got = actor(weights, np.array([0.5, 0.25]))
    medial = math.tanh(0.5) - math.tanh(0.5)
    np.testing.assert_allclose(got.activity, [math.tanh(0.5), -math.tanh(0.5)])
    np.testing.assert_allclose(got.action, [medial, -3.0 * math.tanh(0.5)], atol=1e-15)


@pytest.mark.parametrize(("now", "rate"), [(0, 0.5), (250, 0.375), (1000, 0.0), (1001, 0.0)])
def test_rate_declines_linearly_to_0(now: int, rate: float) -> None:
    assert actor_rate(0.5, now, 1000) == pytest.approx(rate)


@pytest.mark.parametrize(
    ("delta", "variance", "n"),
    [(-0.1, 1.0, 0), (0.0, 1.0, 0), (1e-9, 1.0, 1), (1.0, 1.0, 1), (1.01, 1.0, 2), (0.5, 0.01, 5)],
)
def test_number_of_updates_is_the_surprise_in_standard_deviations(delta, variance, n) -> None:
    assert n_updates(delta, variance) == n


def test_step_is_hand_computed() -> None:
    weights = ActorWeights(hidden=np.array([[1.0, 2.0]]), output=np.array([[3.0], [-1.0]]))
    activity = np.array([0.5])
    output = ActorOutput(activity, np.array([1.5, -0.5]))
    got = actor_step(
        weights, np.array([10.0, 0.0]), output, np.array([1.6, -0.7]), rate=2.0, shrinkage=0.01
    )
    # Surplus (0.1, -0.2); hidden: (3 * 0.1 + 0.2) (1 - 0.25) = 0.375, times 2 * (10, 0).
    np.testing.assert_allclose(got.hidden, [[0.99 + 7.5, 1.98]])
    np.testing.assert_allclose(got.output, [[3.1], [-1.2]])
