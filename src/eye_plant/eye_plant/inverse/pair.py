"""Which activations give a wanted vergence: exact against the static equilibrium.

Medial and lateral rectus are driven alike in both eyes, so a pair of activations has one vergence.
Vergence rises with the medial activation and falls with the lateral one; the pairs of equal
vergence form a line in the plane of the two.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from eye_plant.mechanics.mujoco_model import MechanicsConfig
from eye_plant.mechanics.oculomotor import Oculomotor
from lockstep import InputError

Limits = tuple[tuple[float, float], tuple[float, float]]
Pair = tuple[float, float]


def pair_limits(lowest: Sequence[float], highest: Sequence[float]) -> Limits:
    """Return ((lowest, highest) medial, (lowest, highest) lateral)."""
    medial, lateral = zip(lowest, highest, strict=True)
    return medial, lateral


FULL_RANGE: Limits = ((0.0, 1.0), (0.0, 1.0))

_TOLERANCE_DEG = 1e-7
# Far below what is measured, and far above rounding.
_ACCEPTED_DEG = 1e-3
_MAX_ITERATIONS = 80
# Along an edge of the limits: between two of them the vergence is so straight that two or three
# evaluations find a root.
_N_SAMPLES = 33


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
        self._start_rad: np.ndarray | None = None
        self._corners_deg: dict[Pair, float] = {}
        self._samples_deg: dict[tuple[Pair, Pair], np.ndarray] = {}

    def vergence_deg(self, medial: float, lateral: float) -> float:
        """Sum of both eyes' adduction at the static equilibrium of a pair of activations."""
        self._start_rad = None
        return self._vergence_deg(medial, lateral)

    def adduction_deg(self, medial: float, lateral: float) -> tuple[float, float]:
        """Return the adduction of the left and the right eye at rest with a pair of activations."""
        self.vergence_deg(medial, lateral)
        left, right = self._eyes.data.qpos[[0, 3]]
        return math.degrees(float(left)), math.degrees(float(right))

    def vergence_range_deg(self, limits: Limits) -> Pair:
        """Return the least and the largest vergence that pairs of activations in limits give."""
        (medial_low, medial_high), (lateral_low, lateral_high) = limits
        return (
            self._corner_deg((medial_low, lateral_high)),
            self._corner_deg((medial_high, lateral_low)),
        )

    def activation_pair(self, vergence_deg: float, fraction: float, limits: Limits) -> Pair:
        """Return the (medial, lateral) pair at a fraction of the line of equal vergence in limits.

        fraction in [0, 1]: 0 is the end of least activation, equal differences are equal
        distances along the line's chord, so a uniform fraction is uniform on the line.
        limits: ((lowest, highest) medial, (lowest, highest) lateral).
        Raises InputError when no pair inside the limits gives the vergence, or when eyes that come
        from straight ahead settle elsewhere with it: muscles that all pull hard, or such as no
        surgeon leaves, may have two equilibria.
        """
        if not 0.0 <= fraction <= 1.0:
            raise InputError(f"fraction: expected 0 to 1, got {fraction}")
        low = self._end(vergence_deg, limits, 0)
        high = self._end(vergence_deg, limits, 1)
        medial, lateral = (a + fraction * (b - a) for a, b in zip(low, high, strict=True))
        # The line is nearly straight: keep the coordinate that runs farther, mend the other.
        if abs(high[0] - low[0]) >= abs(high[1] - low[1]):
            lateral = self._mend(
                lambda a: self._vergence_deg(medial, a) - vergence_deg, lateral, limits[1]
            )
        else:
            medial = self._mend(
                lambda a: self._vergence_deg(a, lateral) - vergence_deg, medial, limits[0]
            )
        if abs(self.vergence_deg(medial, lateral) - vergence_deg) > _ACCEPTED_DEG:
            raise InputError(
                f"expected muscles with one equilibrium for each pair of activations; with "
                f"medial {medial:.3g} and lateral {lateral:.3g} eyes that start straight ahead do "
                f"not reach a vergence of {vergence_deg:g} deg"
            )
        return medial, lateral

    def activations(
        self, vergence_deg: float, fraction: float, limits: Limits
    ) -> tuple[float, ...]:
        """Return the activations (12,) of `activation_pair`, the other muscles at tonic level."""
        pair = self.activation_pair(vergence_deg, fraction, limits)
        return tuple(self._eyes.activations_from(*pair).tolist())

    def check(self, vergence_deg: float) -> None:
        """Raise InputError unless some pair of activations gives the vergence; quick."""
        self._edge(vergence_deg, FULL_RANGE, 0)

    def optimal(self, vergence_deg: float, limits: Limits = FULL_RANGE) -> OptimalPair:
        """Least metabolic rate of the horizontal recti with gaze correct (K17: C*).

        The rate rises with either activation, so the least is where the line of equal vergence
        ends for lack of activation to give back: one muscle silent.
        Raises InputError when no pair of activations within limits gives the vergence.
        """
        medial, lateral = self._end(vergence_deg, limits, 0)
        self._vergence_deg(medial, lateral)
        rate_w = self._eyes.horizontal_metabolic_rate_w()
        return OptimalPair(float(medial), float(lateral), rate_w)

    def _vergence_deg(self, medial: float, lateral: float) -> float:
        activations = self._eyes.activations_from(medial, lateral)
        self._eyes.rest(activations, self._start_rad)
        self._start_rad = self._eyes.data.qpos.copy()
        return math.degrees(float(self._start_rad[0] + self._start_rad[3]))

    def _corner_deg(self, pair: Pair) -> float:
        """Return the vergence at a corner of the limits, solved from scratch once."""
        if pair not in self._corners_deg:
            self._corners_deg[pair] = self.vergence_deg(*pair)
        return self._corners_deg[pair]

    def _end(self, vergence_deg: float, limits: Limits, i_end: int) -> Pair:
        """Return the end of the line with the least (0) or the most (1) activation in limits."""
        pair, interval = self._edge(vergence_deg, limits, i_end)
        activations, vergences_deg = self._sampled(pair, interval)
        errors_deg = vergences_deg - vergence_deg
        # The line's end lies between the first two neighbours on either side of it.
        is_between = (errors_deg[:-1] * errors_deg[1:] <= 0.0) & (np.diff(errors_deg) != 0.0)
        if not is_between.any():
            raise _no_pair(vergence_deg, limits)
        i = int(np.argmax(is_between))
        self._start_rad = None
        return pair(
            _root(
                lambda a: self._vergence_deg(*pair(a)) - vergence_deg,
                (float(activations[i]), float(activations[i + 1])),
                (float(errors_deg[i]), float(errors_deg[i + 1])),
            )
        )

    def _sampled(
        self, pair: Callable[[float], Pair], interval: Pair
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return activations along an edge and the vergences there, solved from scratch once."""
        activations = np.linspace(*interval, _N_SAMPLES)
        ends = pair(interval[0]), pair(interval[1])
        if ends not in self._samples_deg:
            self._samples_deg[ends] = np.array([self.vergence_deg(*pair(a)) for a in activations])
        return activations, self._samples_deg[ends]

    def _edge(
        self, vergence_deg: float, limits: Limits, i_end: int
    ) -> tuple[Callable[[float], Pair], Pair]:
        """Return the edge of the limits with that end of the line: its pairs, and its interval."""
        medial, lateral = limits[0][i_end], limits[1][i_end]
        edges: tuple[tuple[Callable[[float], Pair], Pair], ...] = (
            (lambda a: (a, lateral), limits[0]),
            (lambda a: (medial, a), limits[1]),
        )
        for pair, interval in edges:
            low, high = (self._corner_deg(pair(a)) - vergence_deg for a in interval)
            if low * high <= 0.0 and low != high:
                return pair, interval
        raise _no_pair(vergence_deg, limits)

    def _mend(self, error_deg: Callable[[float], float], guess: float, interval: Pair) -> float:
        """Bring a guess near a root to it by secants, inside the interval."""
        before, after = guess, guess + (1e-3 if guess < sum(interval) / 2.0 else -1e-3)
        error_before, error_after = error_deg(before), error_deg(after)
        for _ in range(_MAX_ITERATIONS):
            if (
                abs(error_before) < _TOLERANCE_DEG
                or error_before == error_after
                or before == after  # twice at an end of the interval
            ):
                break
            slope = (error_after - error_before) / (after - before)
            after, error_after = before, error_before
            before = min(max(before - error_before / slope, interval[0]), interval[1])
            error_before = error_deg(before)
        return before


def _no_pair(vergence_deg: float, limits: Limits) -> InputError:
    return InputError(
        f"no medial activation in {limits[0]} with a lateral one in {limits[1]} gives a "
        f"vergence of {vergence_deg:g} deg"
    )


def _root(function: Callable[[float], float], interval: Pair, values: Pair) -> float:
    """Where a monotone function vanishes; values are the function's at the interval's ends.

    False position with the Illinois weights: keeps a bracket, and is faster than halving it.
    """
    (low, high), (f_low, f_high) = interval, values
    middle = low if abs(f_low) < abs(f_high) else high
    if min(abs(f_low), abs(f_high)) < _TOLERANCE_DEG:
        return middle
    for _ in range(_MAX_ITERATIONS):
        middle = low + (high - low) * f_low / (f_low - f_high)
        f_middle = function(middle)
        if abs(f_middle) < _TOLERANCE_DEG:
            break
        if f_middle * f_high < 0.0:
            low, f_low = high, f_high
        else:
            f_low *= 0.5
        high, f_high = middle, f_middle
    return middle
