"""The critic: temporal-difference learning of a linear value function, rule by rule.

Time is in the names: _t is now, _tm1 the observation before; the reward r_t is measured in the
state that the action a_tm1 led to.
"""

import numpy as np
from numpy.typing import NDArray


def td_error(r_t: float, discount: float, v_t: float, v_tm1: float) -> float:
    """Return delta_t = r_t + discount V(s_t) - V(s_tm1), both values by the same weights.

    K17 II, with the reward's index shifted by one (ours: the reward belongs to the state reached).
    """
    return r_t + discount * v_t - v_tm1


def value(weights: NDArray[np.float64], state: NDArray[np.float64]) -> float:
    """Return V(s) = v . s, both (n_state,)."""
    return float(weights @ state)


def critic_step(
    weights: NDArray[np.float64],
    state_tm1: NDArray[np.float64],
    delta_t: float,
    learning_rate: float,
) -> NDArray[np.float64]:
    """Return v + alpha delta_t s_tm1 (K17 eq. 3; the gradient of v . s is s), (n_state,)."""
    return weights + learning_rate * delta_t * state_tm1


def bounded_rate(learning_rate: float, state: NDArray[np.float64], limit: float) -> float:
    """Return the learning rate, or limit / |s|^2 where that is less; state: (n_state,).

    A step of rate alpha takes alpha |s|^2 of a TD error from V(s): twice the error or more, and the
    weights grow without end while the state lasts (step-size bounds: Dabney & Barto 2012).
    """
    energy = float(state @ state)
    return learning_rate if learning_rate * energy <= limit else limit / energy
