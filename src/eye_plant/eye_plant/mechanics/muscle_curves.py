"""Hill-type muscle curves, as MuJoCo's muscle actuator evaluates them.

Tendons are rigid, so the fibre length is the path length less the tendon's slack length. With
``l`` the fibre length in optimal lengths, a muscle of peak force F0 at activation ``a`` that does
not move pulls with

    F = F0 (a FL(l) + FP(l)).

These are the same piecewise polynomials as ``mju_muscleGain`` and ``mju_muscleBias``, written for
arrays: the energetics need the parts of the force, MuJoCo returns only the sum.
"""

from numba import float64, vectorize


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
