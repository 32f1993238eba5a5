"""The numbers of the two eyes: geometry, muscles, orbit, energetics of each parameter set.

Points are given for both eyes at once as (forward, nasal, up) from the eye's centre, in metres.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from eye_plant.metabolics import Energetics

Point = tuple[float, float, float]

GRAM_FORCE_N = 9.80665e-3


@dataclass(frozen=True)
class MuscleParameters:
    """One extraocular muscle: its path over a pulley to the globe, and its Hill-type unit.

    shortest, longest: fibre lengths, in optimal lengths, at which the active force vanishes;
    passive_stiffness and lengthening_gain: see muscles.py; tonic_activation: its level when
    nobody commands it.
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


# k17 ------------------------------------------------------------------------------------------
# OpenEyeSim (Priamikov et al. 2016), the plant behind K17, takes 100.48 gram-force for newtons:
# its forces and masses are some hundred and twenty times too large. Activations mean the same
# gaze and the same cost here as there only if we keep that.
#
# Paths, optimal and slack lengths of the horizontal recti are OpenEyeSim's, laid into the
# horizontal plane (its pulleys are up to 1 mm off it): K17 rotates eyes about the vertical only.
# Peak forces (the lateral one fixed, it sets the scale), force-length shapes and the orbit were
# fitted by least squares to OpenEyeSim's static map of adduction over medial and lateral
# activation (11 x 11 points and its spline on medial [0, 0.2] x lateral [0, 0.1]) and to the
# single-muscle points of K17's optimal cost. Masses are OpenEyeSim's own.
_K17_HORIZONTAL = {
    "medial_rectus": MuscleParameters(
        origin_m=(-0.030, 0.017, 0.0),
        pulley_m=(-0.005, 0.014, 0.0),
        insertion_m=(0.009, 0.009, 0.0),
        peak_force_n=92.502,
        optimal_length_m=0.03192,
        slack_length_m=0.00491,
        max_velocity_per_s=60.0,
        mass_kg=0.01750,
        shortest=0.3007,
        longest=1.7480,
        passive_stiffness=0.51776,
    ),
    "lateral_rectus": MuscleParameters(
        origin_m=(-0.034, 0.013, 0.0),
        pulley_m=(-0.008, -0.012, 0.0),
        insertion_m=(0.007, -0.010, 0.0),
        peak_force_n=100.48,
        optimal_length_m=0.0375,
        slack_length_m=0.00771,
        max_velocity_per_s=60.0,
        mass_kg=0.01593,
        shortest=0.8547,
        longest=1.9884,
        passive_stiffness=0.58193,
    ),
}


def _as_in_k17(muscle: MuscleParameters) -> MuscleParameters:
    """A vertical muscle in OpenEyeSim's units: gram-force for newtons, mass to match.

    ours: no passive force and no tonic level, so that commands to the horizontal recti turn the
    eyes about the vertical only, as in K17. Mass = F0 l_opt x 4.228e-3 kg/(N m), the ratio of
    OpenEyeSim's lateral rectus (1057 kg/m^3 over a specific tension of 0.25 MPa).
    """
    peak_force_n = muscle.peak_force_n / GRAM_FORCE_N
    return MuscleParameters(
        origin_m=muscle.origin_m,
        pulley_m=muscle.pulley_m,
        insertion_m=muscle.insertion_m,
        peak_force_n=peak_force_n,
        optimal_length_m=muscle.optimal_length_m,
        slack_length_m=muscle.slack_length_m,
        max_velocity_per_s=60.0,
        mass_kg=4.228e-3 * peak_force_n * muscle.optimal_length_m,
        shortest=0.3,
        longest=1.9,
        passive_stiffness=0.0,
    )


# anatomical -----------------------------------------------------------------------------------
# Paths and Hill parameters: the OpenSim eye model of upat_eye_model v3 (CC-BY 4.0).
# Masses: in-vivo volumes (Clark & Demer 2016) x 1.06 g/ml for the recti.
_ANATOMICAL = {
    "medial_rectus": MuscleParameters(
        origin_m=(-0.030, 0.017, 0.0006),
        pulley_m=(-0.0053, 0.0146, 0.00014),
        insertion_m=(0.0088, 0.0096, 0.0),
        peak_force_n=1.574,
        optimal_length_m=0.04084,
        slack_length_m=0.0038,
        max_velocity_per_s=4.62,
        mass_kg=0.75e-3,
        shortest=0.5,
        longest=1.6,
        passive_stiffness=1.0,
    ),
    "lateral_rectus": MuscleParameters(
        origin_m=(-0.034, 0.013, 0.0006),
        pulley_m=(-0.0102, -0.012, 0.0003),
        insertion_m=(0.0065, -0.0101, 0.0),
        peak_force_n=1.471,
        optimal_length_m=0.04898,
        slack_length_m=0.0084,
        max_velocity_per_s=3.85,
        mass_kg=0.71e-3,
        shortest=0.5,
        longest=1.6,
        passive_stiffness=1.0,
    ),
    "superior_rectus": MuscleParameters(
        origin_m=(-0.0317, 0.016, 0.0036),
        pulley_m=(-0.0092, 0.002, 0.012),
        insertion_m=(0.0076, 0.0, 0.0104),
        peak_force_n=1.177,
        optimal_length_m=0.04487,
        slack_length_m=0.0054,
        max_velocity_per_s=4.20,
        mass_kg=0.54e-3,
        shortest=0.5,
        longest=1.6,
        passive_stiffness=1.0,
    ),
    "inferior_rectus": MuscleParameters(
        origin_m=(-0.0317, 0.016, -0.0024),
        pulley_m=(-0.0042, 0.0042, -0.0128),
        insertion_m=(0.00805, 0.0, -0.0102),
        peak_force_n=1.427,
        optimal_length_m=0.04549,
        slack_length_m=0.0048,
        max_velocity_per_s=4.14,
        mass_kg=0.60e-3,
        shortest=0.5,
        longest=1.6,
        passive_stiffness=1.0,
    ),
    "superior_oblique": MuscleParameters(
        origin_m=(-0.0308, 0.0164, 0.0011),
        pulley_m=(0.0082, 0.0152, 0.0122),
        insertion_m=(-0.0044, -0.0029, 0.011),
        peak_force_n=0.603,
        optimal_length_m=0.03956,
        slack_length_m=0.0265,
        max_velocity_per_s=4.77,
        mass_kg=0.3e-3,
        shortest=0.5,
        longest=1.6,
        passive_stiffness=1.0,
    ),
    "inferior_oblique": MuscleParameters(
        origin_m=(0.0113, 0.0111, -0.0154),
        pulley_m=(-0.00718, 0.0, -0.0135),
        insertion_m=(-0.008, -0.009, 0.0),
        peak_force_n=0.559,
        optimal_length_m=0.04110,
        slack_length_m=0.0015,
        max_velocity_per_s=4.59,
        mass_kg=0.3e-3,
        shortest=0.5,
        longest=1.6,
        passive_stiffness=1.0,
    ),
}

K17 = ParameterSet(
    muscles=MappingProxyType(
        _K17_HORIZONTAL
        | {
            name: _as_in_k17(muscle)
            for name, muscle in _ANATOMICAL.items()
            if name not in _K17_HORIZONTAL
        }
    ),
    orbit=OrbitParameters(
        globe_mass_kg=7.5e-3,
        globe_inertia_kg_m2=4.32e-7,
        globe_radius_m=0.012,
        wrap_radius_m=0.0119,
        stiffness_n_m=(
            (1.30535, 0.127987, 0.632833),
            (1.30535, 0.0, 0.632833),
            (1.30535, 0.0, 0.632833),
        ),
        rest_rad=(0.0238526, 0.0, 0.0),
        # ours: K17 has no time. Damping, activation time and period are such that any command
        # within the limits has settled when the period ends.
        damping_n_m_s=0.014,
    ),
    # K17's cost, W per eye: 2.229 A_MR^0.6 + 2.030 A_LR^0.6 with A = max(a, 0.005), which is
    # OpenEyeSim's: activation and maintenance heat alone, 80 % fast fibres, S = 1.
    energetics=Energetics(
        scaling=1.0, fast_fraction=0.8, minimum_activation=0.005, length_dependent=False
    ),
    activation_law="linear",
    activation_time_s=(0.010, 0.010),
    control_period_s=0.2,
    timestep_s=0.00625,
)

PARAMETER_SETS: Mapping[str, ParameterSet] = MappingProxyType({"k17": K17})
