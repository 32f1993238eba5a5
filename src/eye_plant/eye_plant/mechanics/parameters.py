"""What it takes to describe the eyes: geometry, muscles, orbit, energetics.

Points are given for both eyes at once as (forward, nasal, up) from the eye's centre, in metres.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

Point = tuple[float, float, float]

GRAM_FORCE_N = 9.80665e-3


class Energetics(NamedTuple):
    """What the heat of a muscle depends on besides its state, as the compiled functions take it.

    scaling: 1.0 anaerobic, 1.5 aerobic (Umberger 2003, S); fast_fraction: share of fast fibres;
    minimum_activation: floor of the activation that is charged, not of the muscle's own;
    length_dependent: whether heat falls with the isometric force above the optimal length.
    """

    scaling: float = 1.0
    fast_fraction: float = 0.8
    minimum_activation: float = 0.0
    length_dependent: bool = True


@dataclass(frozen=True)
class MuscleParameters:
    """One extraocular muscle: its path over a pulley to the globe, and its Hill-type unit.

    shortest, longest: fibre lengths, in optimal lengths, at which the active force vanishes;
    passive_stiffness: see muscles.py; lengthening_gain: greatest active force of a stretched
    muscle, over the isometric one; tonic_activation: its level when nobody commands it.
    """

    origin_m: Point
    pulley_m: Point
    insertion_m: Point
    peak_force_n: float
    optimal_length_m: float
    slack_length_m: float
    max_velocity_per_s: float
    mass_kg: float
    shortest: float
    longest: float
    passive_stiffness: float
    lengthening_gain: float = 1.2
    tonic_activation: float = 0.0


@dataclass(frozen=True)
class OrbitParameters:
    """Globe and passive orbital tissue.

    The tissue's torque about one axis is -(k1 x + k2 x^2 + k3 x^3) - B dx/dt, x the angle from
    its rest position; axes in the order adduction, elevation, intorsion.
    """

    globe_mass_kg: float
    globe_inertia_kg_m2: float
    globe_radius_m: float
    wrap_radius_m: float
    stiffness_n_m: tuple[Point, Point, Point]
    rest_rad: Point
    damping_n_m_s: float


@dataclass(frozen=True)
class ParameterSet:
    """Everything that distinguishes one set from the other.

    activation_time_s: rise and fall; activation_law: "linear" for one exact exponential,
    "muscle" for Millard's dependence of the time constants on the activation.
    """

    muscles: Mapping[str, MuscleParameters]
    orbit: OrbitParameters
    energetics: Energetics
    activation_law: str
    activation_time_s: tuple[float, float]
    control_period_s: float
    timestep_s: float
