"""The MuJoCo model of two eyes, without anything to look at.

World frame: x forward, y left, z up, metres; the eyes at (0, +-baseline / 2, height). Each eye
turns about its centre by three nested hinges (Fick's order): adduction about the head's vertical,
elevation about the eye's transverse axis, intorsion about the line of sight. Positive is toward
the nose, up, and with the upper pole toward the nose, so mirror images have equal angles.
"""

import math
from dataclasses import dataclass
from types import MappingProxyType

import mujoco
import numpy as np

from eye_plant.mechanics.anatomical import ANATOMICAL
from eye_plant.mechanics.k17 import K17
from eye_plant.mechanics.parameters import MuscleParameters, OrbitParameters, ParameterSet, Point
from lockstep import MUSCLE_NAMES, SIDES, check_settings, setting
from lockstep.command_space import MUSCLES

AXES = ("adduction", "elevation", "intorsion")
N_MUSCLES = len(MUSCLE_NAMES)

PARAMETER_SETS = MappingProxyType({"k17": K17, "anatomical": ANATOMICAL})

HIDDEN_GROUP = 4


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
        "shift of each muscle's insertion backwards along its path; negative: resected",
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
            _add_muscle(spec, config, side, muscle)
    return spec


def _to_world(point_m: Point, i_side: int) -> np.ndarray:
    """(forward, nasal, up) to MuJoCo's (forward, left, up); the nose is right of the left eye."""
    forward, nasal, up = point_m
    return np.array([forward, -nasal if i_side == 0 else nasal, up])


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
            stiffness=orbit.stiffness_n_m[i_axis],
            springref=rest_rad[i_axis],
            damping=[orbit.damping_n_m_s, 0.0, 0.0],
        )


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


def _add_muscle(spec: mujoco.MjSpec, config: MechanicsConfig, side: str, muscle: str) -> None:
    """Path origin, pulley, around the globe, insertion; a Hill-type actuator pulls on it."""
    name, i_side = f"{side}_{muscle}", SIDES.index(side)
    i_muscle = MUSCLE_NAMES.index(name)
    parameters, orbit = config.parameters.muscles[muscle], config.parameters.orbit
    insertion_m = receded_insertion_m(parameters, orbit, config.recession_mm[i_muscle])
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
    _add_actuator(spec, config.parameters, name, parameters, config.strength[i_muscle])


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
