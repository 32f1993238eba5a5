"""How changes of activation turn one eye, learned from its own movements.

Each movement changes the activations of the eye's muscles and turns the eye, as its pictures show.
A regression learns what changes do (a forward model), and a wanted turn is found by inverting it
(Jordan & Rumelhart 1992). The equilibrium of an eye bends with its place, so the change has
products with the activations half-way through the movement, up to the second degree; that is exact
to the third order. There is no constant: muscles that do not change turn nothing.

Dimensions: n_muscles; n_places, products of activations of degree 0 to 2; n_turns, 3: to the right,
up, and clockwise.
"""

import math

import numpy as np
from numpy.typing import NDArray

from vergence_rl.gaze.descent import (
    ACTIVATION,
    CHANGE,
    HALF,
    change_for,
    places_half_way,
    slopes_half_way,
)
from vergence_rl.gaze.fading_regression import FadingRegression

Floats = NDArray[np.float64]

N_TURNS = 3
_RIDGE_SHARE = 1e-5
_LEAST_MEMORY = 2000.0


class EyeTurns(FadingRegression):
    """Owns the regression of an eye's turns on changes of activation."""

    def __init__(self, lowest: Floats, highest: Floats, memory_share: float = 0.0) -> None:
        """Know nothing: every change is 0.

        lowest, highest: activations (n_muscles,) between which commands stay; memory_share: see
        GazeConfig.
        """
        self._memory_share = memory_share
        self._limits = (np.array(lowest, np.float64), np.array(highest, np.float64))
        self._n_muscles = n_muscles = len(lowest)
        n_inputs = n_muscles * len(places_half_way(*self._limits))
        # What fewer movements say of so many inputs would throw the eye about.
        self._n_needed = 2 * n_inputs
        super().__init__(n_inputs, (N_TURNS,), ridge_share=_RIDGE_SHARE, counted="n_movements")

    def learn(self, activations: Floats, change: Floats, turns_deg: Floats) -> None:
        """Learn from a movement.

        activations: (n_muscles,) before it; change: (n_muscles,) that was made; turns_deg:
        (n_turns,) that it led to. All finite.
        """
        a, d = self._scaled(activations, change)
        x = np.outer(d, places_half_way(a, HALF * d)).ravel()
        kept = 1.0
        if self._memory_share:
            kept = math.exp(-1.0 / max(_LEAST_MEMORY, self._memory_share * self.n_learned))
        self.add(x, turns_deg, kept=kept)

    def turns_deg(self, activations: Floats, change: Floats) -> Floats:
        """Return the turns (n_turns,) that a change is expected to lead to; see `learn`."""
        a, d = self._scaled(activations, change)
        expected: Floats = self._slopes(a, d) @ d
        return expected

    @property
    def is_known(self) -> bool:
        """Whether enough movements are known to rely on."""
        return self.n_learned >= self._n_needed

    def slopes_deg(self, activations: Floats) -> Floats:
        """Return the turns per unit of each activation, (n_turns, n_muscles), of small changes."""
        a, d = self._scaled(activations, np.zeros(self._n_muscles))
        return self._slopes(a, d) / CHANGE

    def change_for(
        self, activations: Floats, wanted_deg: Floats, near: Floats | None = None
    ) -> Floats:
        """Return the change of activations (n_muscles,) for wanted turns, the first of n_turns.

        The nearest such change to `near`, (n_muscles,), by default to none, within the limits: step
        by step along the slopes half-way, each the least one of the muscles that are not at a
        limit. As long as few movements are known, it is `near`.
        """
        n_muscles = self._n_muscles
        a, d = self._scaled(activations, np.zeros(n_muscles) if near is None else near)
        least, most = ((limit - activations) / CHANGE for limit in self._limits)
        d = np.clip(d, least, most)
        if self.is_known:
            weights = self._solved()[: len(wanted_deg)]
            d = change_for(weights, a, d, wanted_deg, (least, most))
        return CHANGE * d

    def _slopes(self, a: Floats, d: Floats) -> Floats:
        """Return the turns per change half-way through a movement, (n_turns, n_muscles)."""
        return slopes_half_way(self._solved(), a, HALF * d)

    def _solved(self) -> Floats:
        """Return the weights of places in the slopes, (n_turns, n_muscles, n_places)."""
        return self.weights().reshape(N_TURNS, self._n_muscles, -1)

    def _scaled(self, activations: Floats, change: Floats) -> tuple[Floats, Floats]:
        return activations / ACTIVATION - 1.0, change / CHANGE
