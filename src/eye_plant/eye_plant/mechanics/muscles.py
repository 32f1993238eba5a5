"""The muscles: their paths, MuJoCo's actuators that make their forces, and these forces' curves.

Tendons are rigid, so the fibre length is the path length less the tendon's slack length. With
``l`` the fibre length in optimal lengths, a muscle of peak force F0 at activation ``a`` that does
not move pulls with

    F = F0 (a FL(l) + FP(l)).

These are the same piecewise polynomials as ``mju_muscleGain`` and ``mju_muscleBias``, written for
arrays: the energetics need the parts of the force, MuJoCo returns only the sum.
"""

import math

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from eye_plant.mechanics.parameters import MuscleParameters, OrbitParameters, ParameterSet, Point
from lockstep import SIDES

Array = NDArray[np.float64]

# Of the geoms, sites and tendons that nobody draws.
HIDDEN_GROUP = 4


def receded_insertion_m(
    muscle: MuscleParameters, orbit: OrbitParameters, recession_mm: float
) -> Point:
    """Return the insertion (forward, nasal, up) in m, moved toward the pulley along the globe.

    recession_mm: length of the arc; below 0 away from the pulley (a resection).
    """
    insertion, pulley = np.array(muscle.insertion_m), np.array(muscle.pulley_m)
    radius = float(np.linalg.norm(insertion))
    toward = pulley - insertion * (pulley @ insertion) / radius**2
    toward *= radius / np.linalg.norm(toward)
    turn = 1e-3 * recession_mm / orbit.globe_radius_m
    forward, nasal, up = math.cos(turn) * insertion + math.sin(turn) * toward
    return float(forward), float(nasal), float(up)


def _to_world(point_m: Point, i_side: int) -> np.ndarray:
    """(forward, nasal, up) to MuJoCo's (forward, left, up); the nose is right of the left eye."""
    forward, nasal, up = point_m
    return np.array([forward, -nasal if i_side == 0 else nasal, up])


def add_muscle(
    spec: mujoco.MjSpec,
    parameter_set: ParameterSet,
    side: str,
    muscle: str,
    *,
    recession_mm: float,
    strength: float,
) -> None:
    """Give an eye of the spec a muscle: its path, and a Hill-type actuator that pulls on it.

    The path: origin, pulley, around the globe, insertion. recession_mm: as for receded_insertion_m;
    strength: factor on the active force.
    """
    name, i_side = f"{side}_{muscle}", SIDES.index(side)
    parameters, orbit = parameter_set.muscles[muscle], parameter_set.orbit
    insertion_m = receded_insertion_m(parameters, orbit, recession_mm)
    orbital, eye = spec.body(f"{side}_orbit"), spec.body(f"{side}_eye")
    # Says on which side of the globe the tendon runs: outside it, between pulley and insertion.
    middle = np.add(parameters.pulley_m, parameters.insertion_m)
    outside_m = tuple(2.0 * orbit.globe_radius_m * middle / np.linalg.norm(middle))
    for body, part, point_m in (
        (orbital, "origin", parameters.origin_m),
        (orbital, "pulley", parameters.pulley_m),
        (orbital, "outside", outside_m),
        (eye, "insertion", insertion_m),
    ):
        body.add_site(
            name=f"{name}_{part}",
            pos=_to_world(point_m, i_side),
            size=[5e-4, 5e-4, 5e-4],
            group=HIDDEN_GROUP,
        )
    tendon = spec.add_tendon(name=name, group=HIDDEN_GROUP)
    tendon.wrap_site(f"{name}_origin")
    tendon.wrap_site(f"{name}_pulley")
    tendon.wrap_geom(f"{side}_wrap", f"{name}_outside")
    tendon.wrap_site(f"{name}_insertion")
    _add_actuator(spec, parameter_set, name, parameters, strength)


def _add_actuator(
    spec: mujoco.MjSpec,
    parameter_set: ParameterSet,
    name: str,
    muscle: MuscleParameters,
    strength: float,
) -> None:
    actuator = spec.add_actuator(
        name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_TENDON, group=HIDDEN_GROUP
    )
    # Lengths of the path at which the fibre is 0 and 1 optimal length long: a rigid tendon.
    slack_m = muscle.slack_length_m
    actuator.lengthrange = [slack_m, slack_m + muscle.optimal_length_m]
    actuator.set_to_muscle(
        timeconst=parameter_set.activation_time_s,
        tausmooth=0.0,
        range=[0.0, 1.0],
        force=muscle.peak_force_n,
        scale=1.0,
        lmin=muscle.shortest,
        lmax=muscle.longest,
        vmax=muscle.max_velocity_per_s,
        fpmax=muscle.passive_stiffness or 1.0,
        fvmax=muscle.lengthening_gain,
    )
    # A weak muscle has lost active force only; its tissue is as stiff as before.
    gain = np.array(actuator.gainprm)
    gain[2] *= strength
    actuator.gainprm = gain
    if muscle.passive_stiffness == 0.0:
        actuator.biastype = mujoco.mjtBias.mjBIAS_NONE
    if parameter_set.activation_law == "linear":
        actuator.dyntype = mujoco.mjtDyn.mjDYN_FILTEREXACT
    actuator.ctrllimited = True
    actuator.ctrlrange = [0.0, 1.0]


# In NumPy, which needs no wrapper: that of a ufunc of numba's is compiled at each start.
def force_length(length: ArrayLike, shortest: ArrayLike, longest: ArrayLike) -> Array:
    """Active force at full activation and zero velocity, as a fraction of the peak force.

    FL(l): four parabolas that meet smoothly half-way between shortest, 1 and longest. All broadcast
    against one another. length: fibre length in optimal lengths; shortest < 1 < longest: where the
    force vanishes.
    """
    at, least, most = (np.asarray(a, np.float64) for a in (length, shortest, longest))
    rise = np.where(at < 1.0, (at - least) / (1.0 - least), (most - at) / (most - 1.0))
    rise = np.minimum(np.maximum(rise, 0.0), 1.0)
    return np.where(rise < 0.5, 2.0 * rise**2, 1.0 - 2.0 * (1.0 - rise) ** 2)


def passive_force_length(length: ArrayLike, longest: ArrayLike, stiffness: ArrayLike) -> Array:
    """Force of the unexcited fibres, as a fraction of the peak force.

    FP(l): zero up to 1, a parabola to (1 + longest) / 2, straight from there on; its slope there
    is ``stiffness`` per (longest - 1) / 2 optimal lengths. All broadcast against one another.
    """
    half = 0.5 * (np.asarray(longest, np.float64) - 1.0)
    stretch = np.maximum(np.asarray(length, np.float64) - 1.0, 0.0) / half
    return np.asarray(stiffness) * np.where(stretch <= 1.0, 0.5 * stretch**2, stretch - 0.5)
