"""A ridge regression that learns one observation after the other, and may forget older ones."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class FadingRegression:
    """Owns the sums of the regression y = W^T x; x: (n_inputs,), y: a number or (n_outputs,)."""

    def __init__(
        self, n_inputs: int, shape_of_y: tuple[int, ...], *, ridge_share: float, counted: str
    ) -> None:
        """Know nothing.

        ridge_share: of the mean square of an input, the penalty on W (Hoerl & Kennard 1970);
        counted: name of the number of observations in the state.
        """
        self._ridge_share, self._counted = ridge_share, counted
        self.n_learned = 0
        self._squares = np.zeros((n_inputs, n_inputs))
        self._products = np.zeros((n_inputs, *shape_of_y))
        self._weights: Floats | None = None

    def add(self, x: Floats, y: Floats | float, *, kept: float = 1.0) -> None:
        """Add an observation, after which older ones have so much of their weight."""
        self._squares *= kept
        self._squares += np.outer(x, x)
        self._products *= kept
        self._products += np.multiply.outer(x, y)
        self.n_learned += 1
        self._weights = None

    def weights(self) -> Floats:
        """Return W^T, (n_inputs,) or (n_outputs, n_inputs); 0 before the first observation."""
        if self._weights is None:
            n_inputs = len(self._squares)
            penalty = self._ridge_share * np.trace(self._squares) / n_inputs or 1.0
            squares = self._squares + penalty * np.eye(n_inputs)
            self._weights = np.ascontiguousarray(np.linalg.solve(squares, self._products).T)
        return self._weights

    def state(self) -> dict[str, NDArray[Any]]:
        """Return all that learning has changed, for restore, as copies."""
        return {
            self._counted: np.array(self.n_learned),
            "squares": self._squares.copy(),
            "products": self._products.copy(),
        }

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Continue from what state returned, bit for bit."""
        self.n_learned = int(state[self._counted])
        self._squares = state["squares"].copy()
        self._products = state["products"].copy()
        self._weights = None
