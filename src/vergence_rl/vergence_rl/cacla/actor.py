"""The actor of CACLA+VAR (van Hasselt & Wiering 2007; K17 eq. 4): it copies what did better.

A network of one hidden layer of tanh units with linear outputs. Dimensions: n_state, n_hidden,
n_muscles (medial before lateral). Time is in the names: _t is now, _tm1 before.
"""

import math
from dataclasses import dataclass

import numpy as np
from numba import float64, njit, void
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


def actor(weights: ActorWeights, state: NDArray[np.float64]) -> ActorOutput:
    """Return A(s) = W2 tanh(W1 s) (K17 II), for one state (n_state,)."""
    activity = np.tanh(weights.hidden @ state)
    return ActorOutput(activity, weights.output @ activity)


def actor_rate(initial_rate: float, training_iteration: int, n_iterations: int) -> float:
    """Return the rate that falls linearly from initial_rate to 0 at n_iterations (K17 II)."""
    return initial_rate * max(0.0, 1.0 - training_iteration / n_iterations)


def n_updates(delta_t: float, variance_t: float) -> int:
    """Return ceil(delta / sqrt(var)) for a good surprise, 0 for any other (K17 eq. 4)."""
    if delta_t <= 0.0:
        return 0
    return math.ceil(delta_t / math.sqrt(variance_t))


def actor_step(
    weights: ActorWeights,
    state_tm1: NDArray[np.float64],
    output_tm1: ActorOutput,
    executed_tm1: NDArray[np.float64],
    *,
    rate: float,
    shrinkage: float,
) -> ActorWeights:
    """Return the weights after one step from the actor's action to the executed one.

    W2 <- W2 + rate (a - A) h^T
    W1 <- (1 - shrinkage) W1 + rate (W2^T (a - A) * (1 - h^2)) s^T, with W2 from before the step

    (K17 eq. 4.)

    state_tm1: s, (n_state,).
    output_tm1: h and A, of these weights in that state.
    executed_tm1: a, (n_muscles,).
    rate: learning rate times number of updates.
    shrinkage: of the hidden weights.
    """
    surplus = executed_tm1 - output_tm1.action
    slope = (weights.output.T @ surplus) * (1.0 - output_tm1.activity**2)
    hidden = np.empty_like(weights.hidden)
    _shrink_and_add(weights.hidden, 1.0 - shrinkage, rate * slope, state_tm1, hidden)
    output = weights.output + rate * np.outer(surplus, output_tm1.activity)
    return ActorWeights(hidden, output)


@njit(
    void(float64[:, ::1], float64, float64[::1], float64[::1], float64[:, ::1]),
    cache=True,
    nogil=True,
)
def _shrink_and_add(
    old: NDArray[np.float64],
    keep: float,
    left: NDArray[np.float64],
    right: NDArray[np.float64],
    new: NDArray[np.float64],
) -> None:
    """Fill new with keep * old + left right^T, in one pass over the memory."""
    for j in range(old.shape[0]):
        for i in range(old.shape[1]):
            new[j, i] = keep * old[j, i] + left[j] * right[i]
