"""The anatomical parameter set: real forces, masses, paths and time constants.

Paths and Hill parameters (peak force, optimal, slack length, maximal velocity) are those of the
public OpenSim eye model upat_eye_model v3 (CC-BY 4.0). Masses of the recti are in-vivo volumes
(Clark & Demer 2016) times 1.06 g/ml; those of the obliques are estimates, see below.
"""

from functools import partial
from types import MappingProxyType

from eye_plant.mechanics.parameters import (
    Energetics,
    MuscleParameters,
    OrbitParameters,
    ParameterSet,
)

# The curve shapes that all six share. ours: the active force spans 0.35 to 1.6 optimal lengths, the
# passive one is such that the agonist pulls 30 to 50 gram-force at 45 deg into its field against
# its antagonist and the orbit (Collins et al. 1981).
_muscle = partial(MuscleParameters, shortest=0.35, longest=1.6, passive_stiffness=2.0)

# Tonic activations hold the eyes straight ahead, at the tensions nearest to 12 gram-force in the
# horizontal, 10 in the vertical recti and 6 in the obliques (least squares under zero torque).
#
# Masses of the obliques (ours): belly volume from the largest cross-section in MRI of normal
# orbits, 18.4 mm^2 for the superior (Manchandia & Demer 2014) and 13.4 mm^2 for the inferior
# oblique (Kono & Demer 2003), scaled as the volume of the recti to theirs: the medial rectus has
# 0.75 g and 35.1 mm^2 (Ela-Dalman et al. 2008), 21.4 mg per mm^2.
MUSCLES = {
    "medial_rectus": _muscle(
        origin_m=(-0.030, 0.017, 0.0006),
        pulley_m=(-0.0053, 0.0146, 0.00014),
        insertion_m=(0.0088, 0.0096, 0.0),
        peak_force_n=1.574,
        optimal_length_m=0.04084,
        slack_length_m=0.0038,
        max_velocity_per_s=4.62,
        mass_kg=0.75e-3,
        tonic_activation=0.080318,
    ),
    "lateral_rectus": _muscle(
        origin_m=(-0.034, 0.013, 0.0006),
        pulley_m=(-0.0102, -0.012, 0.0003),
        insertion_m=(0.0065, -0.0101, 0.0),
        peak_force_n=1.471,
        optimal_length_m=0.04898,
        slack_length_m=0.0084,
        max_velocity_per_s=3.85,
        mass_kg=0.71e-3,
        tonic_activation=0.085589,
    ),
    "superior_rectus": _muscle(
        origin_m=(-0.0317, 0.016, 0.0036),
        pulley_m=(-0.0092, 0.002, 0.012),
        insertion_m=(0.0076, 0.0, 0.0104),
        peak_force_n=1.177,
        optimal_length_m=0.04487,
        slack_length_m=0.0054,
        max_velocity_per_s=4.20,
        mass_kg=0.54e-3,
        tonic_activation=0.087611,
    ),
    "inferior_rectus": _muscle(
        origin_m=(-0.0317, 0.016, -0.0024),
        pulley_m=(-0.0042, 0.0042, -0.0128),
        insertion_m=(0.00805, 0.0, -0.0102),
        peak_force_n=1.427,
        optimal_length_m=0.04549,
        slack_length_m=0.0048,
        max_velocity_per_s=4.14,
        mass_kg=0.60e-3,
        tonic_activation=0.074358,
    ),
    "superior_oblique": _muscle(
        origin_m=(-0.0308, 0.0164, 0.0011),
        pulley_m=(0.0082, 0.0152, 0.0122),
        insertion_m=(-0.0044, -0.0029, 0.011),
        peak_force_n=0.603,
        optimal_length_m=0.03956,
        slack_length_m=0.0265,
        max_velocity_per_s=4.77,
        mass_kg=0.394e-3,
        tonic_activation=0.111840,
    ),
    "inferior_oblique": _muscle(
        origin_m=(0.0113, 0.0111, -0.0154),
        pulley_m=(-0.00718, 0.0, -0.0135),
        insertion_m=(-0.008, -0.009, 0.0),
        peak_force_n=0.559,
        optimal_length_m=0.04110,
        slack_length_m=0.0015,
        max_velocity_per_s=4.59,
        mass_kg=0.287e-3,
        tonic_activation=0.100339,
    ),
}

# Orbital tissue: the same public model, torque -2.225e-3 q - 3.453e-3 q^3 N m about each axis.
# Its damping of 2e-3 N m s is too viscous for saccades; ours was fitted to the main sequence.
# Time constants of activation: about 10 ms up and 40 ms down, with Millard's dependence on the
# activation itself. S = 1.5: these muscles work aerobically.
_TISSUE = (2.225e-3, 0.0, 3.453e-3)

ANATOMICAL = ParameterSet(
    muscles=MappingProxyType(MUSCLES),
    orbit=OrbitParameters(
        globe_mass_kg=7.5e-3,
        globe_inertia_kg_m2=4.32e-7,
        globe_radius_m=0.012,
        wrap_radius_m=0.0119,
        stiffness_n_m=(_TISSUE, _TISSUE, _TISSUE),
        rest_rad=(0.0, 0.0, 0.0),
        damping_n_m_s=3e-4,
    ),
    energetics=Energetics(scaling=1.5, fast_fraction=0.8),
    activation_law="muscle",
    activation_time_s=(0.010, 0.040),
    control_period_s=0.4,
    timestep_s=0.0025,
)
