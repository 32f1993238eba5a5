"""Saccades of one eye, learned from its own movements.

Each movement changes the activations of the eye's muscles and turns the eye, as its pictures show.
A regression learns what changes do (a forward model), and a wanted turn is found by inverting it
(Jordan & Rumelhart 1992). The equilibrium of an eye bends with its place, so the change has
products with the activations half-way through the movement, up to the second degree; that is exact
to the third order. There is no constant: muscles that do not change turn nothing.

Dimensions: n_muscles, n_inputs; n_turns, 3: to the right, up, and clockwise.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lockstep.errors import InputError

Floats = NDArray[np.float64]

N_TURNS = 3
# Both are of the order of 1 in these units.
_ACTIVATION, _CHANGE = 0.1, 0.01
_RIDGE_SHARE = 1e-5
_N_STEPS, _DIFFERENCE = 6, 1e-3


class Saccades:
    """Owns the sums of the regression."""

    def __init__(self, lowest: Floats, highest: Floats) -> None:
        """Know nothing: every change is 0.

        lowest, highest: activations (n_muscles,) between which commands stay.
        """
        self._limits = (np.array(lowest), np.array(highest))
        n_muscles = len(lowest)
        self._pairs = np.triu_indices(n_muscles)
        n_inputs = n_muscles * (1 + n_muscles + len(self._pairs[0]))
        self._n_muscles = n_muscles
        self.n_movements = 0
        self._squares = np.zeros((n_inputs, n_inputs))
        self._products = np.zeros((n_inputs, N_TURNS))
        self._weights: Floats | None = None

    def learn(self, activations: Floats, change: Floats, turns_deg: Floats) -> None:
        """Learn from a movement.

        activations: (n_muscles,) before it; change: (n_muscles,) that was made; turns_deg:
        (n_turns,) that it led to.
        Raises InputError, and learns nothing, for other shapes or numbers that are not finite.
        """
        a, d = self._scaled(activations, change)
        x, y = self._inputs(a, d), _checked("turns", turns_deg, N_TURNS)
        self._squares += np.outer(x, x)
        self._products += np.outer(x, y)
        self.n_movements += 1
        self._weights = None

    def turns_deg(self, activations: Floats, change: Floats) -> Floats:
        """Return the turns (n_turns,) that a change is expected to lead to; see `learn`."""
        a, d = self._scaled(activations, change)
        expected: Floats = self._inputs(a, d) @ self._regressed()
        return expected

    def change(self, activations: Floats, wanted_deg: Floats) -> Floats:
        """Return the change of activations (n_muscles,) for wanted turns (n_turns,).

        By Newton's method, each step the least that does it, then cut at the limits; see `learn`.
        """
        a, d = self._scaled(activations, np.zeros(self._n_muscles))
        wanted, weights = _checked("turns", wanted_deg, N_TURNS), self._regressed()
        nearest, farthest = ((limit - activations) / _CHANGE for limit in self._limits)
        beside = _DIFFERENCE * np.eye(self._n_muscles)
        for _ in range(_N_STEPS):
            slopes = [self._inputs(a, d + e) - self._inputs(a, d - e) for e in beside]
            turned = (np.array(slopes) / (2.0 * _DIFFERENCE)) @ weights
            left = wanted - self._inputs(a, d) @ weights
            d = np.clip(d + np.linalg.lstsq(turned.T, left)[0], nearest, farthest)
        return _CHANGE * d

    def _regressed(self) -> Floats:
        if self._weights is None:
            n_inputs = len(self._squares)
            penalty = _RIDGE_SHARE * np.trace(self._squares) / n_inputs or 1.0
            squares = self._squares + penalty * np.eye(n_inputs)
            self._weights = np.asarray(np.linalg.solve(squares, self._products), np.float64)
        return self._weights

    def _scaled(self, activations: Floats, change: Floats) -> tuple[Floats, Floats]:
        return (
            _checked("activations", activations, self._n_muscles) / _ACTIVATION - 1.0,
            _checked("change", change, self._n_muscles) / _CHANGE,
        )

    def _inputs(self, a: Floats, d: Floats) -> Floats:
        """Return d and its products with a half-way and with the products of a, (n_inputs,)."""
        half_way = a + 0.5 * _CHANGE / _ACTIVATION * d
        squares = np.outer(half_way, half_way)[self._pairs]
        return np.outer(d, np.concatenate([[1.0], half_way, squares])).ravel()

    def state(self) -> dict[str, NDArray[Any]]:
        """Return all that learning has changed, for restore, as copies."""
        return {
            "n_movements": np.array(self.n_movements),
            "squares": self._squares.copy(),
            "products": self._products.copy(),
        }

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Continue from what state returned, bit for bit."""
        self.n_movements = int(state["n_movements"])
        self._squares = state["squares"].copy()
        self._products = state["products"].copy()
        self._weights = None


def _checked(name: str, values: Floats, n: int) -> Floats:
    values = np.asarray(values, np.float64)
    if values.shape != (n,) or not np.isfinite(values).all():
        raise InputError(f"{name}: expected {n} finite numbers, got {values.tolist()}")
    return values
