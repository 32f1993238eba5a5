"""What activations cost: the energy penalty that they will have (D23).

Muscles that pull against each other hold the eyes where they are and cost energy. A regression
learns how the penalty depends on each activation. `descent.lowered` lowers it.

A muscle's rate grows the more slowly the more it is driven already, so each activation has a term
in proportion and one with its square root. With such a penalty few muscles are cheaper than many,
and descent ends where most are silent.
"""

import numpy as np
from numpy.typing import NDArray

from vergence_rl.gaze.fading_regression import FadingRegression

Floats = NDArray[np.float64]

# Activations are of this order. The root is bent where its slope would be infinite.
_ACTIVATION, _BEND = 0.1, 0.05
_RIDGE_SHARE = 1e-6
# The penalty of an activation may change in the course of training.
_LEAST_MEMORY, _MEMORY_SHARE = 2000.0, 0.2


class Effort(FadingRegression):
    """Owns the regression of the energy penalty on the activations (n_muscles,)."""

    def __init__(self, n_muscles: int) -> None:
        """Know nothing: no activation costs anything."""
        super().__init__(1 + 2 * n_muscles, (), ridge_share=_RIDGE_SHARE, counted="n_learned")

    def learn(self, activations: Floats, energy_penalty: float) -> None:
        """Learn what activations (n_muscles,) cost."""
        a = activations / _ACTIVATION
        x = np.concatenate([[1.0], a, np.sqrt(a + _BEND)])
        self.add(
            x, energy_penalty, kept=1.0 - 1.0 / max(_LEAST_MEMORY, _MEMORY_SHARE * self.n_learned)
        )

    def slopes(self, activations: Floats) -> Floats:
        """Return what more of each activation costs at activations, (n_muscles,); 0 at first."""
        if self.n_learned < _LEAST_MEMORY:
            return np.zeros(len(activations))
        straight, bent = self.weights()[1:].reshape(2, -1)
        root = np.sqrt(activations / _ACTIVATION + _BEND)
        slopes: Floats = (straight + 0.5 * bent / root) / _ACTIVATION
        return slopes
