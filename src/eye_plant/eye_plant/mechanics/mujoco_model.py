"""The MuJoCo model of two eyes, without anything to look at.

World frame: x forward, y left, z up, metres; the eyes at (0, +-baseline / 2, height). Each eye
turns about its centre by three nested hinges (Fick's order): adduction about the head's vertical,
elevation about the eye's transverse axis, intorsion about the line of sight. Positive is toward
the nose, up, and with the upper pole toward the nose, so mirror images have equal angles.
"""

from dataclasses import dataclass
from types import MappingProxyType

import mujoco
import numpy as np

from eye_plant.mechanics.anatomical import ANATOMICAL
from eye_plant.mechanics.k17 import K17
from eye_plant.mechanics.muscles import HIDDEN_GROUP, add_muscle
from eye_plant.mechanics.parameters import ParameterSet
from lockstep import MUSCLE_NAMES, SIDES, check_settings, setting
from lockstep.command_space import MUSCLES

AXES = ("adduction", "elevation", "intorsion")
N_MUSCLES = len(MUSCLE_NAMES)

PARAMETER_SETS = MappingProxyType({"k17": K17, "anatomical": ANATOMICAL})


@dataclass(frozen=True)
class MechanicsConfig:
    """Two eyes: which parameters, how far apart, how long a control period, which surgery.

    Twelve numbers follow the order of MUSCLE_NAMES, two are left, right.
    """

    parameter_set: str = setting(
        "k17", "set of eyes: the paper's or anatomical ones", choices=tuple(PARAMETER_SETS)
    )
    baseline_m: float = setting(0.056, "distance of the eyes' centres", "m", least=0.025, most=1)
    eye_height_m: float = setting(
        1.7, "height of the eyes above the ground", "m", least=0, most=100
    )
    control_period_s: float = setting(
        0.0,
        "simulated time between two observations; 0: the parameter set's own",
        "s",
        least=0,
        most=10,
    )
    timestep_s: float = setting(
        0.0, "time step of the simulation; 0: the parameter set's own", "s", least=0, most=0.01
    )
    moves: str = setting(
        "simulated",
        "how the eyes reach the equilibrium of a command: simulated over the control period, or"
        " at once, without lengths, forces and heat on the way",
        choices=("simulated", "at_once"),
    )
    strength: tuple[float, ...] = setting(
        (1.0,) * N_MUSCLES,
        "factor on each muscle's active force, 0 paralysed, 1 healthy",
        least=0,
        most=10,
        n_entries=N_MUSCLES,
    )
    recession_mm: tuple[float, ...] = setting(
        (0.0,) * N_MUSCLES,
        "shift of each muscle's insertion backwards along its path; negative: advanced",
        "mm",
        least=-10,
        most=10,
        n_entries=N_MUSCLES,
    )
    rest_adduction_deg: tuple[float, ...] = setting(
        (0.0, 0.0),
        "change of the resting adduction that the orbital tissue gives each eye",
        "deg",
        least=-30,
        most=30,
        n_entries=2,
    )
    rest_elevation_deg: tuple[float, ...] = setting(
        (0.0, 0.0),
        "change of the resting elevation that the orbital tissue gives each eye",
        "deg",
        least=-30,
        most=30,
        n_entries=2,
    )
    tissue_stiffness: float = setting(
        1.0,
        "factor on the stiffness of the orbital tissue; with 0.5 surgery of anatomical eyes turns"
        " them as far as patients'",
        least=0.1,
        most=10,
    )

    def __post_init__(self) -> None:
        """Refuse what no pair of eyes can be."""
        check_settings(self)

    @property
    def parameters(self) -> ParameterSet:
        """The numbers behind the parameter set's name."""
        return PARAMETER_SETS[self.parameter_set]

    @property
    def period_s(self) -> float:
        """Simulated time between two observations."""
        return self.control_period_s or self.parameters.control_period_s


def build_spec(config: MechanicsConfig) -> mujoco.MjSpec:
    """Both eyes in their orbits, bodies left_eye and right_eye, muscles in MUSCLE_NAMES' order."""
    parameters = config.parameters
    spec = mujoco.MjSpec()
    spec.modelname = f"eyes_{config.parameter_set}"
    spec.compiler.degree = False
    spec.option.gravity = np.zeros(3)
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.disableflags |= (
        mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    )
    spec.option.timestep = parameters.timestep_s
    for i_side, side in enumerate(SIDES):
        _add_eye(spec, config, i_side)
        for muscle in MUSCLES:
            i_muscle = MUSCLE_NAMES.index(f"{side}_{muscle}")
            recession_mm, strength = config.recession_mm[i_muscle], config.strength[i_muscle]
            add_muscle(spec, parameters, side, muscle, recession_mm=recession_mm, strength=strength)
    return spec


def _add_eye(spec: mujoco.MjSpec, config: MechanicsConfig, i_side: int) -> None:
    side, orbit = SIDES[i_side], config.parameters.orbit
    centre = np.array([0.0, config.baseline_m * (0.5 - i_side), config.eye_height_m])
    spec.worldbody.add_body(name=f"{side}_orbit", pos=centre)
    eye = spec.worldbody.add_body(
        name=f"{side}_eye",
        pos=centre,
        mass=orbit.globe_mass_kg,
        inertia=np.full(3, orbit.globe_inertia_kg_m2),
        ipos=np.zeros(3),
        explicitinertial=True,
    )
    for name, radius_m in (("globe", orbit.globe_radius_m), ("wrap", orbit.wrap_radius_m)):
        eye.add_geom(
            name=f"{side}_{name}",
            type=mujoco.mjtGeom.mjGEOM_SPHERE,
            size=[radius_m, 0.0, 0.0],
            mass=0.0,
            contype=0,
            conaffinity=0,
            group=HIDDEN_GROUP,
        )
    nasal = 1.0 if i_side else -1.0
    axes = ((0.0, 0.0, nasal), (0.0, -1.0, 0.0), (-nasal, 0.0, 0.0))
    surgery_rad = np.radians([config.rest_adduction_deg[i_side], config.rest_elevation_deg[i_side]])
    rest_rad = np.add(orbit.rest_rad, [*surgery_rad, 0.0])
    for i_axis, axis in enumerate(AXES):
        eye.add_joint(
            name=f"{side}_eye_{axis}",
            type=mujoco.mjtJoint.mjJNT_HINGE,
            axis=axes[i_axis],
            stiffness=config.tissue_stiffness * np.array(orbit.stiffness_n_m[i_axis]),
            springref=rest_rad[i_axis],
            damping=[orbit.damping_n_m_s, 0.0, 0.0],
        )
