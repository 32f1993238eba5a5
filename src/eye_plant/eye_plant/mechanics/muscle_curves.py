"""Hill-type muscle curves, as MuJoCo's muscle actuator evaluates them.

Tendons are rigid, so the fibre length is the path length less the tendon's slack length. With
``l`` the fibre length in optimal lengths and ``v`` its velocity in maximal shortening velocities
(lengthening positive), a muscle of peak force F0 at activation ``a`` pulls with

    F = F0 (a FL(l) FV(v) + FP(l)).

These are the same piecewise polynomials as ``mju_muscleGain`` and ``mju_muscleBias``, written for
arrays: the energetics and the figures need the parts of the force, MuJoCo returns only the sum.
"""

import numpy as np
from numba import float64, vectorize
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


@vectorize([float64(float64, float64, float64)], cache=True)
def force_length(length: float, shortest: float, longest: float) -> float:
    """Active force at full activation and zero velocity, as a fraction of the peak force.

    FL(l): four parabolas that meet smoothly half-way between shortest, 1 and longest. A function of
    arrays. length: fibre length in optimal lengths; shortest < 1 < longest: where the force
    vanishes.
    """
    below = (length - shortest) / (1.0 - shortest)
    above = (longest - length) / (longest - 1.0)
    rise = min(max(below if length < 1.0 else above, 0.0), 1.0)
    return 2.0 * rise**2 if rise < 0.5 else 1.0 - 2.0 * (1.0 - rise) ** 2


@vectorize([float64(float64, float64, float64)], cache=True)
def passive_force_length(length: float, longest: float, stiffness: float) -> float:
    """Force of the unexcited fibres, as a fraction of the peak force.

    FP(l): zero up to 1, a parabola to (1 + longest) / 2, straight from there on; its slope there
    is ``stiffness`` per (longest - 1) / 2 optimal lengths. A function of arrays.
    """
    stretch = max(length - 1.0, 0.0) / (0.5 * (longest - 1.0))
    return stiffness * (0.5 * stretch**2 if stretch <= 1.0 else stretch - 0.5)


def force_velocity(velocity: ArrayLike, lengthening_gain: ArrayLike) -> Array:
    """Active force at a velocity, as a fraction of the isometric one.

    FV(v): 0 at v = -1, 1 at v = 0, ``lengthening_gain`` from v = lengthening_gain - 1 on.
    velocity: in maximal shortening velocities, lengthening positive.
    """
    velocity = np.asarray(velocity)
    excess = np.asarray(lengthening_gain) - 1.0
    shortening = np.maximum(velocity + 1.0, 0.0) ** 2
    lengthening = 1.0 + excess - np.maximum(excess - velocity, 0.0) ** 2 / excess
    return np.where(velocity <= 0.0, shortening, lengthening)
