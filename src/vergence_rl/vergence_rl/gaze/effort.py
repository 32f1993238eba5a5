"""What activations cost (D23).

Muscles that pull against each other hold the eyes where they are and cost energy. A regression
learns how the price depends on each activation. `descent.lowered` lowers it.

A muscle's rate grows the more slowly the more it is driven already, so each activation has a term
in proportion and one with its square root. With such a price few muscles are cheaper than many, and
descent ends where most are silent.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# Activations are of this order. The root is bent where its slope would be infinite.
_ACTIVATION, _BEND = 0.1, 0.05
_RIDGE_SHARE = 1e-6
# The price of an activation may change in the course of training.
_LEAST_MEMORY, _MEMORY_SHARE = 2000.0, 0.2


def price_of(reconstruction_error: Sequence[float], reward: float) -> float:
    """Return lambda C of a reward r = -E - lambda C (K17 eq. 5), E the sum of both errors."""
    return -reward - sum(reconstruction_error)


class Effort:
    """Owns the sums of the regression of the price on the activations (n_muscles,)."""

    def __init__(self, n_muscles: int) -> None:
        """Know nothing: no activation costs anything."""
        n_inputs = 1 + 2 * n_muscles
        self._n_learned = 0
        self._squares = np.zeros((n_inputs, n_inputs))
        self._products = np.zeros(n_inputs)
        self._weights: Floats | None = None

    def learn(self, activations: Floats, price: float) -> None:
        """Learn what activations (n_muscles,) cost."""
        a = activations / _ACTIVATION
        x = np.concatenate([[1.0], a, np.sqrt(a + _BEND)])
        kept = 1.0 - 1.0 / max(_LEAST_MEMORY, _MEMORY_SHARE * self._n_learned)
        self._squares = kept * self._squares + np.outer(x, x)
        self._products = kept * self._products + price * x
        self._n_learned += 1
        self._weights = None

    def slopes(self, activations: Floats) -> Floats:
        """Return what more of each activation costs at activations, (n_muscles,); 0 at first."""
        if self._n_learned < _LEAST_MEMORY:
            return np.zeros(len(activations))
        if self._weights is None:
            n_inputs = len(self._squares)
            penalty = _RIDGE_SHARE * np.trace(self._squares) / n_inputs
            squares = self._squares + penalty * np.eye(n_inputs)
            self._weights = np.linalg.solve(squares, self._products)
        straight, bent = self._weights[1:].reshape(2, -1)
        root = np.sqrt(activations / _ACTIVATION + _BEND)
        slopes: Floats = (straight + 0.5 * bent / root) / _ACTIVATION
        return slopes

    def state(self) -> dict[str, NDArray[Any]]:
        """Return all that learning has changed, for restore, as copies."""
        return {
            "effort_n_learned": np.array(self._n_learned),
            "effort_squares": self._squares.copy(),
            "effort_products": self._products.copy(),
        }

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Continue from what state returned, bit for bit."""
        self._n_learned = int(state["effort_n_learned"])
        self._squares = state["effort_squares"].copy()
        self._products = state["effort_products"].copy()
        self._weights = None
