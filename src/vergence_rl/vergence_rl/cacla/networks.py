"""The actor's network: one hidden layer of tanh units, linear outputs.

Dimensions: n_state, n_hidden, n_muscles (medial before lateral).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class ActorWeights:
    """hidden: (n_hidden, n_state) input weights W1; output: (n_muscles, n_hidden) W2."""

    hidden: NDArray[np.float64]
    output: NDArray[np.float64]


@dataclass(frozen=True)
class ActorOutput:
    """activity: (n_hidden,) of the hidden units; action: (n_muscles,) change of activation."""

    activity: NDArray[np.float64]
    action: NDArray[np.float64]


def uniform_weights(
    generator: np.random.Generator, shape: tuple[int, ...], width: float
) -> NDArray[np.float64]:
    """Return weights drawn uniformly from [-width, width]."""
    return generator.uniform(-width, width, shape)


def actor(weights: ActorWeights, state: NDArray[np.float64]) -> ActorOutput:
    """Return A(s) = W2 tanh(W1 s) (K17 II), for one state (n_state,)."""
    activity = np.tanh(weights.hidden @ state)
    return ActorOutput(activity, weights.output @ activity)
