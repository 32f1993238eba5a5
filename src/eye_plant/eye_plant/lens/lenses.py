"""Two lenses and two pupils: ciliary muscles and sphincters, dioptres and diameters.

    A(t) = a(t) (1 - c) A_max(age)                      accommodation, D
    p(t) = 8 mm - s(t) (1 - c) 6 mm                     diameter of the pupil
    f(t) = A(t) - R + S / (1 - v S) + C                 dioptres in focus
    da/dt = (u - a) / tau

a, s: activations of ciliary muscle and sphincter in [0, 1], u: command; c: cycloplegia; R:
refraction; S: spectacle lens at the distance v, C: contact lens, in D. An eye is in focus where f
is 1 / distance.

A_max = 18.5 D - 0.3 D/year x age, the mean of measured amplitudes (Hofstetter 1950, of Duane's
and Donders' data). Ciliary muscles at rest leave 1.5 D (Leibowitz & Owens 1978: 1.52 D in the dark,
SD 0.77 among 220 students). Pupils go from 2 to 8 mm (Watson & Yellott 2012). tau is 0.25 s for
lenses: 92 % of a change in the 0.64 s that one of 2 D takes (Campbell & Westheimer 1960; their
delay of 0.36 s is left out). ours: that activation and accommodation are proportional; 0.3 s for
pupils, which narrow and widen equally fast.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eye_plant.lens.config import VERTEX_M, LensesConfig
from lockstep import INTRAOCULAR_NAMES, SIDES, InputError

Array = NDArray[np.float64]

WIDEST_M, NARROWEST_M = 0.008, 0.002
# Of ciliary muscle and sphincter.
TIME_CONSTANTS_S = np.array([0.25, 0.3])
_SHAPE = len(SIDES), len(TIME_CONSTANTS_S)


@dataclass(frozen=True)
class LensState:
    """What lenses and pupils are doing; all arrays are copies, left before right.

    activations: (4,) in INTRAOCULAR_NAMES' order; accommodation_d, focus_d, pupil_m: (2,);
    accommodation_d_s, pupil_m_s: (2,) their rates of change.
    """

    activations: Array
    accommodation_d: Array
    focus_d: Array
    pupil_m: Array
    accommodation_d_s: Array
    pupil_m_s: Array

    def error_d(self, distance_m: float) -> Array:
        """Return the error of accommodation (2,): positive where eyes are focused too near."""
        error_d: Array = self.focus_d - 1.0 / distance_m
        return error_d


class Lenses:
    """Both eyes' lenses and pupils. What they do depends on the settled state and what followed."""

    def __init__(self, config: LensesConfig) -> None:
        """Be at rest."""
        self._amplitude_d = amplitude_d(config.age_years)
        self._unparalysed = 1.0 - np.array(config.cycloplegia)[:, None]
        spectacles_d, contact_d = np.array([config.spectacles_d, config.contact_lenses_d])
        self._added_d = (
            spectacles_d / (1.0 - VERTEX_M * spectacles_d)
            + contact_d
            - np.array(config.refraction_d)
        )
        self._pinhole_m = 1e-3 * np.array(config.pinhole_mm)
        ciliary = config.resting_accommodation_d / max(self._amplitude_d, 1e-9)
        sphincter = (WIDEST_M - 1e-3 * config.resting_pupil_mm) / (WIDEST_M - NARROWEST_M)
        self.resting_activations = np.clip(np.tile([ciliary, sphincter], len(SIDES)), 0.0, 1.0)
        self.settle(self.resting_activations)

    def settle(self, activations: Array) -> None:
        """Jump to where activations (4,) lead in the end; raises InputError out of range."""
        self._activations = self._targets = checked(activations).reshape(_SHAPE).copy()

    def advance(self, activations: Array, duration_s: float) -> None:
        """Move towards the target activations (4,) for a while; raises InputError out of range."""
        self._targets = checked(activations).reshape(_SHAPE).copy()
        left = np.exp(-duration_s / TIME_CONSTANTS_S)
        self._activations = self._targets + (self._activations - self._targets) * left

    def focus_d(self, ciliary: Array) -> Array:
        """Return the dioptres in focus (..., 2) of settled ciliary muscles (..., 2) or (..., 1)."""
        focus_d: Array = self._amplitude_d * self._unparalysed[:, 0] * ciliary + self._added_d
        return focus_d

    def state(self) -> LensState:
        """Return copies of the present state."""
        effective = self._unparalysed * self._activations
        rates = self._unparalysed * (self._targets - self._activations) / TIME_CONSTANTS_S
        accommodation_d = self._amplitude_d * effective[:, 0]
        narrowing_m = NARROWEST_M - WIDEST_M
        return LensState(
            activations=self._activations.ravel().copy(),
            accommodation_d=accommodation_d,
            focus_d=accommodation_d + self._added_d,
            pupil_m=np.minimum(WIDEST_M + narrowing_m * effective[:, 1], self._pinhole_m),
            accommodation_d_s=self._amplitude_d * rates[:, 0],
            pupil_m_s=narrowing_m * rates[:, 1],
        )


def amplitude_d(age_years: float) -> float:
    """Return the range of accommodation, 18.5 - 0.3 age, at least 0 (Hofstetter 1950, mean)."""
    return max(0.0, 18.5 - 0.3 * age_years)


def ciliary_activation(accommodation_d: float, age_years: float) -> float:
    """Return the activation that accommodates so far, NaN beyond the range of that age."""
    share = accommodation_d / max(amplitude_d(age_years), 1e-9)
    return share if 0.0 <= share <= 1.0 else math.nan


def checked(activations: Array) -> Array:
    """Return activations as floats, or raise InputError unless (4,) within [0, 1]."""
    activations = np.asarray(activations, np.float64)
    if activations.shape != (len(INTRAOCULAR_NAMES),):
        raise InputError(
            f"expected {len(INTRAOCULAR_NAMES)} activations of lenses and pupils, "
            f"got shape {activations.shape}"
        )
    if not bool(np.all((activations >= 0.0) & (activations <= 1.0))):
        raise InputError(f"activations: expected 0 to 1, got {activations.tolist()}")
    return activations
