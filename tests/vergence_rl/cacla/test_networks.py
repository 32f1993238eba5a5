import math

import numpy as np

from vergence_rl.cacla.networks import ActorWeights, actor, uniform_weights


def test_actor_is_hand_computed() -> None:
    weights = ActorWeights(
        hidden=np.array([[1.0, 0.0], [0.0, -2.0]]), output=np.array([[1.0, 1.0], [0.0, 3.0]])
    )
    got = actor(weights, np.array([0.5, 0.25]))
    medial = math.tanh(0.5) - math.tanh(0.5)
    np.testing.assert_allclose(got.activity, [math.tanh(0.5), -math.tanh(0.5)])
    np.testing.assert_allclose(got.action, [medial, -3.0 * math.tanh(0.5)], atol=1e-15)


def test_initial_weights_fill_their_width() -> None:
    weights = uniform_weights(np.random.default_rng(0), (50, 80), 0.09)
    assert weights.shape == (50, 80)
    assert 0.089 < weights.max() < 0.09
    assert -0.09 < weights.min() < -0.089
