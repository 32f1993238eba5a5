"""The k17 parameter set: OpenEyeSim's static behaviour.

OpenEyeSim (Priamikov et al. 2016), the plant behind K17, takes 100.48 gram-force for newtons:
its forces are about a hundred times too large, its masses about twenty-four times. Activations
mean the same gaze and the same cost here as there only if we keep that.

Paths, optimal and slack lengths of the horizontal recti are OpenEyeSim's, laid into the
horizontal plane (its pulleys are up to 1 mm off it): K17 rotates eyes about the vertical only.
Peak forces (the lateral one fixed, it sets the scale), force-length shapes and the orbit were
fitted by least squares to OpenEyeSim's static map of adduction over medial and lateral
activation (11 x 11 points and its spline on medial [0, 0.2] x lateral [0, 0.1]) and to the
single-muscle points of K17's optimal cost. Masses are OpenEyeSim's own.
"""

from dataclasses import replace
from types import MappingProxyType

from eye_plant.mechanics.anatomical import ANATOMICAL
from eye_plant.mechanics.parameters import GRAM_FORCE_N, Energetics, MuscleParameters, ParameterSet

_HORIZONTAL = {
    "medial_rectus": MuscleParameters(
        origin_m=(-0.030, 0.017, 0.0),
        pulley_m=(-0.005, 0.014, 0.0),
        insertion_m=(0.009, 0.009, 0.0),
        peak_force_n=92.502,
        optimal_length_m=0.03192,
        slack_length_m=0.00491,
        max_velocity_per_s=10.0,
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
        max_velocity_per_s=10.0,
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
    return replace(
        muscle,
        peak_force_n=peak_force_n,
        max_velocity_per_s=10.0,
        mass_kg=4.228e-3 * peak_force_n * muscle.optimal_length_m,
        shortest=0.3,
        longest=1.9,
        passive_stiffness=0.0,
        tonic_activation=0.0,
    )


K17 = ParameterSet(
    muscles=MappingProxyType(
        _HORIZONTAL
        | {
            name: _as_in_k17(muscle)
            for name, muscle in ANATOMICAL.muscles.items()
            if name not in _HORIZONTAL
        }
    ),
    orbit=replace(
        ANATOMICAL.orbit,
        stiffness_n_m=(
            (1.30535, 0.127987, 0.632833),
            (1.30535, 0.0, 0.632833),
            (1.30535, 0.0, 0.632833),
        ),
        rest_rad=(0.0238526, 0.0, 0.0),
        # ours: K17 has no time. Damping, activation time and period are such that any command
        # within the limits has settled when the period ends.
        damping_n_m_s=0.02,
    ),
    # K17's cost, W per eye: 2.229 A_MR^0.6 + 2.030 A_LR^0.6 with A = max(a, 0.005), which is
    # OpenEyeSim's: activation and maintenance heat alone, 80 % fast fibres, S = 1 (D6).
    energetics=Energetics(
        scaling=1.0, fast_fraction=0.8, minimum_activation=0.005, length_dependent=False
    ),
    activation_law="linear",
    activation_time_s=(0.010, 0.010),
    control_period_s=0.2,
    timestep_s=0.01,
)
