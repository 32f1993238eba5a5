"""Which activations give two eyes a wanted gaze, each muscle its own: on the static equilibrium.

A gaze has more activations than angles, so the nearest one to a point that the caller chooses is
taken: Newton's method with the least change of activations.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from eye_plant.gaze_error import gaze_error
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from eye_plant.mechanics.oculomotor import Oculomotor
from eye_plant.turns import NO_TURNS_DEG, TurnsDeg, turned
from lockstep import ALL_MUSCLES, HORIZONTAL_RECTI, CommandSpace, InputError

Array = NDArray[np.float64]

# Angles of two eyes before a plane. The errors are those of gaze_error; version and elevation are
# where both look together, to the right and up.
GAZE_ANGLES = ("horizontal", "vertical", "torsional", "version", "elevation")
ERRORS = GAZE_ANGLES[:3]
# Where the left camera looks, to the right and up: another way to say version and elevation.
LEFT_SIGHT = ("left azimuth", "left elevation")
_ANGLES = (*GAZE_ANGLES, *LEFT_SIGHT)
# Those that a command space turns.
TURNED_ANGLES = {
    HORIZONTAL_RECTI: ("horizontal", "version"),
    ALL_MUSCLES: GAZE_ANGLES,
}

_TOLERANCE_DEG = 1e-6
_MAX_STEPS = 30
# Steps along the slopes at tonic level; eyes far from there have others.
_QUICK_STEPS = 10
_MOST_HALVINGS = 8
# Of the steepest: what turns the eyes by less is not used.
_LEAST_SLOPE = 1e-6
_PROBE = 1e-4
_REFERENCE_M = 2.0
# The cheapest activations: reweighted until they change by less, or so often.
_SETTLED = 1e-6
_ACCEPTED_DEG = 1e-3
_MAX_ROUNDS = 25
# Bends the cost's slope at rest, which is infinite there.
_SOFTENING = 1e-3
_LARGEST_CHANGE = 0.05


def _inverse_of(slopes: Array) -> Array:
    """Return the pseudo-inverse: of all changes of activation with a change of gaze the least."""
    return np.asarray(np.linalg.pinv(slopes, rcond=_LEAST_SLOPE), dtype=np.float64)


def _held(names: Sequence[str], wanted_deg: Mapping[str, float]) -> tuple[list[int], Array]:
    """Return the positions of angles among _ANGLES, and what is wanted of them."""
    positions = [_ANGLES.index(name) for name in names]
    return positions, np.array([wanted_deg[name] for name in names])


def _spoken(name: str) -> str:
    article = "an" if name == "elevation" else "a"
    return f"{article} {name} error" if name in ERRORS else f"{article} {name}"


@dataclass(frozen=True)
class LeastCost:
    """The cheapest activations (12,) with a gaze, and what they cost the commanded muscles."""

    activations: Array
    metabolic_rate_w: float


class GazeInverse:
    """Activations of the muscles that a command space has, for a gaze; the others at tonic level.

    Owns a simulation of its own; calls do not influence one another.
    """

    def __init__(
        self,
        config: MechanicsConfig,
        space: CommandSpace,
        lowest: Sequence[float] | Array,
        highest: Sequence[float] | Array,
        turns_deg: TurnsDeg = NO_TURNS_DEG,
    ) -> None:
        """lowest, highest: limits of the activation of each muscle of the space.

        turns_deg: of the cameras in the eyes; the errors are those of what the cameras see.
        """
        self._turns_deg = turns_deg
        self._eyes = Oculomotor(config)
        self._space = space
        self._tonic = self._eyes.tonic_activations
        self._lowest, self._highest = np.array(lowest), np.array(highest)

    def gaze_deg(self, activations: Array, distance_m: float) -> Array:
        """Return GAZE_ANGLES (5,) of eyes at rest with activations (12,) before a plane."""
        return self._settled_deg(activations, distance_m)[: len(GAZE_ANGLES)]

    def left_gaze_deg(self, activations: Array) -> tuple[float, float]:
        """Return azimuth (to the right) and elevation of the left eye at rest."""
        self._eyes.rest(activations)
        azimuth_deg, elevation_deg = np.degrees(self._eyes.data.qpos[:2]).tolist()
        return azimuth_deg, elevation_deg

    def near_tonic(self, aside: Array) -> Array:
        """Return activations (12,) off the tonic level by aside (n_muscles,), within the limits."""
        values = self._tonic[self._space.indices] + aside
        return self._with(np.clip(values, self._lowest, self._highest))

    def returned(self, values: Sequence[float], share: float) -> Array:
        """Return activations (12,) a share of the way from values (n_muscles,) to the tonic level.

        They are those of the tonic level where there are no values, and within the limits.
        """
        tonic = self._tonic[self._space.indices]
        aside = np.array(values) - tonic if len(values) else np.zeros_like(tonic)
        return self.near_tonic((1.0 - share) * aside)

    def activations(
        self, wanted_deg: Mapping[str, float], distance_m: float, aside: Array
    ) -> Array:
        """Return activations (12,) of eyes with the wanted angles, of GAZE_ANGLES or LEFT_SIGHT.

        aside: (n_muscles,) change from the tonic level, of which the part that hardly moves the
        wanted angles says which of all activations with that gaze these are near. Where the limits
        leave no such gaze there, half of it, half of that, and in the end none of it counts.
        Raises InputError, naming the first angle that cannot be had with those before it.
        """
        names = [name for name in _ANGLES if name in wanted_deg]
        nowhere = np.zeros_like(aside)
        nearer = [aside / 2.0**k for k in range(_MOST_HALVINGS)] if aside.any() else []
        for place in (*nearer, nowhere):
            found = self._reached(names, wanted_deg, distance_m, place)
            if found is not None:
                return found
        n_reached = 0
        while self._reached(names[: n_reached + 1], wanted_deg, distance_m, nowhere) is not None:
            n_reached += 1
        name = names[n_reached]
        others = ", ".join(f"{_spoken(n)} of {wanted_deg[n]:.2f}" for n in names[:n_reached])
        before = f" with {others}" if others else ""
        raise InputError(
            f"mechanics: expected muscles that reach {_spoken(name)} of {wanted_deg[name]:.2f} "
            f"deg{before} at {distance_m:g} m, within the limits of their activations; these do not"
        )

    def _reached(
        self, names: Sequence[str], wanted_deg: Mapping[str, float], distance_m: float, aside: Array
    ) -> Array | None:
        """Return activations (12,) with these of the wanted angles, None when there are none."""
        held, wanted = _held(names, wanted_deg)
        slopes = self._slopes[held]
        inverse = _inverse_of(slopes)
        start = aside - inverse @ (slopes @ aside)
        values = np.clip(self._tonic[self._space.indices] + start, self._lowest, self._highest)
        missed = wanted - self._settled_deg(self._with(values), distance_m)[held]
        for step in range(_MAX_STEPS):
            if np.abs(missed).max() < _TOLERANCE_DEG:
                return self._with(values)
            if step >= _QUICK_STEPS:
                slopes = self._slopes_at(self._with(values), distance_m)[held]
                inverse = _inverse_of(slopes)
            values = self._step_to(values, missed, slopes, inverse)
            missed = wanted - self._continued_deg(values, distance_m)[held]
        return None

    def turned(self, values: Array, change_deg: Mapping[str, float]) -> Array:
        """Return activations (n_muscles,) that turn eyes further from those with other ones.

        change_deg: of GAZE_ANGLES, along their slopes at tonic level before a plane at 2 m, whose
        distance hardly matters. Of all such steps the least, as far as the limits allow.
        """
        held, change = _held([*change_deg], change_deg)
        slopes = self._slopes[held]
        return self._step_to(values, change, slopes, _inverse_of(slopes))

    def least(
        self,
        wanted_deg: Mapping[str, float],
        distance_m: float,
        near: LeastCost | None = None,
        dear: Sequence[str] | None = None,
    ) -> LeastCost:
        """Return the least cost of the commanded muscles with the wanted angles, others being free.

        The rate grows more slowly the more a muscle is driven already, so that few muscles hold a
        gaze more cheaply than many: the least of a weighted sum of activations, again and again,
        each weight the slope of the muscle's rate where it was last (Candes, Wakin & Boyd 2008),
        from several first weights: all alike, and one muscle dear. near: the least of a gaze near
        by, to begin with, sooner; dear: the muscles that are dear in turn, all unless given.
        Raises InputError for a gaze that the muscles do not reach.
        """
        n, names = len(self._space.indices), self._space.muscle_names
        first = self.activations(wanted_deg, distance_m, np.zeros(n))
        weights = [np.ones(n)]
        if near is None:
            chosen = [names.index(name) for name in (names if dear is None else dear)]
            weights += [*(1.0 + 9.0 * np.eye(n))[chosen]]
        else:
            weights += [self._cost_slopes(near.activations[self._space.indices])]
        found = [self._cheaper(first, w, wanted_deg, distance_m) for w in weights]
        return min(found, key=lambda least: least.metabolic_rate_w)

    def _cheaper(
        self, activations: Array, weights: Array, wanted_deg: Mapping[str, float], distance_m: float
    ) -> LeastCost:
        """Return the least that reweighting finds from these activations and first weights."""
        # What a quarter of a second is needed for, which each node that never searches would wait.
        from scipy.optimize import linprog  # noqa: PLC0415

        held, wanted = _held([*wanted_deg], wanted_deg)
        values = activations[self._space.indices]
        for _ in range(_MAX_ROUNDS):
            slopes = self._slopes_at(self._with(values), distance_m)[held]
            now = self._settled_deg(self._with(values), distance_m)[held]
            aimed = wanted - now + slopes @ values
            bounds = np.stack(
                [
                    np.maximum(values - _LARGEST_CHANGE, self._lowest),
                    np.minimum(values + _LARGEST_CHANGE, self._highest),
                ],
                axis=1,
            )
            solution = linprog(weights, A_eq=slopes, b_eq=aimed, bounds=bounds)
            if solution.x is None:
                break
            change = np.abs(solution.x - values).max()
            values = np.clip(solution.x, self._lowest, self._highest)
            if change < _SETTLED:
                break
            weights = self._cost_slopes(values)
        now = self._settled_deg(self._with(values), distance_m)[held]
        if np.abs(now - wanted).max() > _ACCEPTED_DEG:
            return LeastCost(activations, math.inf)
        rates_w = self._eyes.settled_metabolic_rate_w()
        return LeastCost(self._with(values), float(rates_w[self._space.indices].sum()))

    def _cost_slopes(self, values: Array) -> Array:
        """Return the slope of each muscle's rate, (n,), as long as now and a little more driven."""
        lengths_m = self._eyes.data.actuator_length
        low, high = (
            self._eyes.musculature.settled_rate_w(self._with(values + more), lengths_m)
            for more in (0.5 * _SOFTENING, 1.5 * _SOFTENING)
        )
        slopes: Array = (high - low)[self._space.indices] / _SOFTENING
        return slopes

    @cached_property
    def _slopes(self) -> Array:
        """Degrees of each of _ANGLES per unit of each activation, (7, n), at tonic level."""
        return self._slopes_at(self._tonic, _REFERENCE_M)

    def _slopes_at(self, activations: Array, distance_m: float) -> Array:
        base = self._settled_deg(activations, distance_m)
        columns = []
        for i in self._space.indices:
            probed = activations.copy()
            probed[i] += _PROBE
            columns.append(self._continued_deg(probed[self._space.indices], distance_m) - base)
        return np.stack(columns, axis=1) / _PROBE

    def _step_to(self, values: Array, missed: Array, slopes: Array, inverse: Array) -> Array:
        """Return activations nearer to the gaze, changed least among those off their limits.

        inverse: of all slopes.
        """
        free = np.ones(len(values), bool)
        step = inverse @ missed
        while True:
            beyond = free & (
                ((values <= self._lowest) & (step < 0)) | ((values >= self._highest) & (step > 0))
            )
            if not beyond.any() or free.sum() <= len(missed):
                return np.clip(values + step, self._lowest, self._highest)
            free &= ~beyond
            step = np.zeros_like(values)
            step[free] = _inverse_of(slopes[:, free]) @ missed

    def _with(self, values: Array) -> Array:
        activations = self._tonic.copy()
        activations[self._space.indices] = values
        return activations

    def _settled_deg(self, activations: Array, distance_m: float) -> Array:
        self._eyes.rest(activations)
        return self._present_deg(distance_m)

    def _continued_deg(self, values: Array, distance_m: float) -> Array:
        self._eyes.rest(self._with(values), self._eyes.data.qpos.copy())
        return self._present_deg(distance_m)

    def _present_deg(self, distance_m: float) -> Array:
        seeing = turned(self._eyes.eye_rotations(), self._turns_deg)
        error = gaze_error(self._eyes.eye_positions_m(), seeing, distance_m)
        left, right = np.degrees(self._eyes.data.qpos).reshape(2, 3)
        forward, to_left, up = seeing[0, :, 0].tolist()
        return np.array(
            [
                error.horizontal_deg,
                error.vertical_deg,
                error.torsional_deg,
                (left[0] - right[0]) / 2.0,
                (left[1] + right[1]) / 2.0,
                math.degrees(math.atan2(-to_left, forward)),
                math.degrees(math.atan2(up, math.hypot(forward, to_left))),
            ]
        )
