import math

import numpy as np

from vergence_rl.cacla.networks import ActorWeights, actor


def test_actor_is_hand_computed() -> None:
    weights = ActorWeights(
        hidden=np.array([[1.0, 0.0], [0.0, -2.0]]), output=np.array([[1.0, 1.0], [0.0, 3.0]])
    )
    got = actor(weights, np.array([0.5, 0.25]))
    medial = math.tanh(0.5) - math.tanh(0.5)
    np.testing.assert_allclose(got.activity, [math.tanh(0.5), -math.tanh(0.5)])
    np.testing.assert_allclose(got.action, [medial, -3.0 * math.tanh(0.5)], atol=1e-15)
