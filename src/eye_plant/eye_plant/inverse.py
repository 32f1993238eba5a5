"""Which activations give a wanted vergence: exact against the static equilibrium.

Medial and lateral rectus are driven alike in both eyes, so a pair of activations has one vergence.
Vergence rises with the medial activation and falls with the lateral one; the pairs of equal
vergence form a line in the plane of the two.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from eye_plant.equilibrium import Equilibrium
from eye_plant.mechanics import Oculomotor
from eye_plant.model import MechanicsConfig
from lockstep.errors import InputError

Limits = tuple[tuple[float, float], tuple[float, float]]
Pair = tuple[float, float]

FULL_RANGE: Limits = ((0.0, 1.0), (0.0, 1.0))

_TOLERANCE_DEG = 1e-9
_MAX_ITERATIONS = 80


@dataclass(frozen=True)
class OptimalPair:
    """The cheapest pair of activations that gives a vergence, and what it costs both eyes."""

    medial: float
    lateral: float
    metabolic_rate_w: float


class Inverse:
    """Activation pairs for a vergence, by root finding on the static equilibrium.

    Owns a simulation of its own; calls do not influence one another.
    """

    def __init__(self, config: MechanicsConfig) -> None:
        """Build bare eyes."""
        self._eyes = Oculomotor(config)
        self._equilibrium = Equilibrium(self._eyes.model, self._eyes.data)
        self._warm: np.ndarray | None = None

    def vergence_deg(self, medial: float, lateral: float) -> float:
        """Sum of both eyes' adduction at the static equilibrium of a pair of activations."""
        self._warm = None
        return self._vergence_deg(medial, lateral)

    def activation_pair(self, vergence_deg: float, fraction: float, limits: Limits) -> Pair:
        """Return the (medial, lateral) pair at a fraction of the line of equal vergence in limits.

        fraction in [0, 1]: 0 is the end of least activation, equal differences are equal
        distances along the line's chord, so a uniform fraction is uniform on the line.
        limits: ((lowest, highest) medial, (lowest, highest) lateral).
        Raises InputError when no pair inside the limits gives the vergence.
        """
        if not 0.0 <= fraction <= 1.0:
            raise InputError(f"fraction must be within [0, 1], got {fraction}")
        self._warm = None
        low = self._end(vergence_deg, limits, 0)
        high = self._end(vergence_deg, limits, 1)
        medial, lateral = (a + fraction * (b - a) for a, b in zip(low, high, strict=True))
        # The line is nearly straight: keep the coordinate that runs farther, solve for the other.
        if abs(high[0] - low[0]) >= abs(high[1] - low[1]):
            solved = self._solve(lambda a: self._vergence_deg(medial, a), vergence_deg, limits[1])
            return medial, lateral if solved is None else solved
        solved = self._solve(lambda a: self._vergence_deg(a, lateral), vergence_deg, limits[0])
        return medial if solved is None else solved, lateral

    def optimal(self, vergence_deg: float) -> OptimalPair:
        """Least metabolic rate of the horizontal recti with gaze correct (K17: C*).

        The rate rises with either activation, so the least is where the line of equal vergence
        ends for lack of activation to give back: one muscle silent.
        Raises InputError when no pair of activations gives the vergence.
        """
        self._warm = None
        medial, lateral = self._end(vergence_deg, FULL_RANGE, 0)
        self._vergence_deg(medial, lateral)
        state_w = self._eyes.state().metabolic_rate_w
        return OptimalPair(medial, lateral, self._eyes.horizontal_metabolic_rate_w(state_w))

    def _vergence_deg(self, medial: float, lateral: float) -> float:
        activations = self._eyes.activations_from(medial, lateral)
        self._equilibrium.solve(activations, self._warm)
        self._warm = self._eyes.data.qpos.copy()
        return math.degrees(float(self._warm[0] + self._warm[3]))

    def _end(self, vergence_deg: float, limits: Limits, i_end: int) -> Pair:
        """Return the end of the line with the least (0) or the most (1) activation in limits."""
        medial, lateral = limits[0][i_end], limits[1][i_end]
        along_medial = self._solve(
            lambda a: self._vergence_deg(a, lateral), vergence_deg, limits[0]
        )
        if along_medial is not None:
            return along_medial, lateral
        along_lateral = self._solve(
            lambda a: self._vergence_deg(medial, a), vergence_deg, limits[1]
        )
        if along_lateral is not None:
            return medial, along_lateral
        raise InputError(
            f"no medial activation in {limits[0]} with a lateral one in {limits[1]} gives a "
            f"vergence of {vergence_deg:g} deg"
        )

    def _solve(
        self, function: Callable[[float], float], wanted: float, interval: Pair
    ) -> float | None:
        """Where a monotone function takes the wanted value inside the interval, None if nowhere.

        False position with the Illinois weights: brackets the root, superlinear.
        """
        low, high = interval
        f_low, f_high = function(low) - wanted, function(high) - wanted
        if abs(f_low) < _TOLERANCE_DEG:
            return low
        if abs(f_high) < _TOLERANCE_DEG:
            return high
        if f_low * f_high > 0.0:
            return None
        for _ in range(_MAX_ITERATIONS):
            middle = low + (high - low) * f_low / (f_low - f_high)
            f_middle = function(middle) - wanted
            if abs(f_middle) < _TOLERANCE_DEG:
                break
            if f_middle * f_high < 0.0:
                low, f_low = high, f_high
            else:
                f_low *= 0.5
            high, f_high = middle, f_middle
        return middle
