"""The noise of hindsight regression: its first shape, that of the first places, and its floor."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# First places that tell their scatter, for each muscle.
_PLACES_PER_MUSCLE = 10
# Of the mean variance, in directions in which first places do not differ.
_LEAST_SHARE = 1e-6
# Of the mean variance, so that a covariance inverts.
_LEAST_VARIANCE_SHARE = 1e-6


class FirstNoise:
    """Learns the scatter of first activations, and makes the first noise of it.

    Muscles differ in how far they turn the eyes, up to tenfold between axes. First places that are
    drawn evenly in angles scatter as the muscles have to move, so noise of that shape tries all
    axes alike. covariance: (n, n) of the noise; metric: (n, n), by which changes of activation are
    multiplied before their length is taken, so that the noise's SD has the same length everywhere.
    """

    def __init__(self, n_muscles: int, variance: float, share: float) -> None:
        """variance: of noise without a shape; share: of the scatter's SD, 0 to do without it."""
        self._variance, self._share = variance, share
        self._n_needed = _PLACES_PER_MUSCLE * n_muscles if share else 0
        self._n_places = 0
        self._sum, self._squares = np.zeros(n_muscles), np.zeros((n_muscles, n_muscles))
        self._derive()

    @property
    def is_known(self) -> bool:
        """Whether enough places have come; nothing is learned from what comes before."""
        return self._n_places >= self._n_needed

    def add(self, place: Floats) -> bool:
        """Add the first activations (n,) of an episode; return whether enough have come."""
        self._n_places += 1
        self._sum += place
        self._squares += np.outer(place, place)
        self._derive()
        return self.is_known

    def state(self) -> dict[str, NDArray[Any]]:
        """Return what has been learned, as copies; of noise without a shape nothing."""
        if not self._share:
            return {}
        return {
            "first_count": np.array(self._n_places),
            "first_sum": self._sum.copy(),
            "first_squares": self._squares.copy(),
        }

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Continue from what `state` returned."""
        if not self._share:
            return
        self._n_places = int(state["first_count"])
        self._sum, self._squares = state["first_sum"].copy(), state["first_squares"].copy()
        self._derive()

    def _derive(self) -> None:
        n = len(self._sum)
        self.covariance, self.metric = self._variance * np.eye(n), np.eye(n)
        if self._share and self.is_known:
            mean = self._sum / self._n_places
            scatter = self._squares / self._n_places - np.outer(mean, mean)
            # Places that are alike in some direction leave a little noise there, so that the
            # metric has an inverse.
            scatter += _LEAST_SHARE * (np.trace(scatter) / n + self._variance) * np.eye(n)
            self.covariance = self._share**2 * scatter
            self.metric = np.sqrt(self._variance) * np.linalg.inv(root_of(self.covariance))


def floored(covariance: Floats) -> Floats:
    """Return the covariance (n, n) with a little variance in all directions, so that it inverts."""
    n = len(covariance)
    return covariance + _LEAST_VARIANCE_SHARE * np.trace(covariance) / n * np.eye(n)


def widened(covariance: Floats, least: Floats) -> Floats:
    """Return the covariance (n, n) with the variance of `least`, (n, n), where it has less.

    least: of full rank. Directions are the axes of the covariance, seen where `least` is round.
    """
    root = root_of(least)
    inverse = np.linalg.inv(root)
    ratios, axes = np.linalg.eigh(inverse @ covariance @ inverse)
    axes = root @ axes
    return (axes * np.maximum(ratios, 1.0)) @ axes.T


def root_of(covariance: Floats) -> Floats:
    """Return the symmetric R with R R = covariance; rounding below zero counts as zero."""
    variances, axes = np.linalg.eigh(covariance)
    return (axes * np.sqrt(np.maximum(variances, 0.0))) @ axes.T
