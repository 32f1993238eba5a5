"""Static measurements of the eyes: maps, inverse, symmetry, pulling directions, tensions."""

import math
from collections.abc import Iterator

import mujoco
import numpy as np

from eye_plant.inverse.pair import Inverse, pair_limits
from eye_plant.mechanics.model import MechanicsConfig
from eye_plant.mechanics.oculomotor import Oculomotor
from eye_plant.mechanics.parameters import GRAM_FORCE_N
from eye_plant.validation.openeyesim import SINGLE_MUSCLE_POINTS, Maps, power_law_w
from eye_plant.validation.row import Row
from eye_plant.validation.saccades import holding_pair
from eye_plant.validation.secondary_gaze import worst_torsion_deg
from eye_plant.vergence import desired_vergence_deg
from lockstep.command_space import HIGHEST_ACTIVATIONS, LOWEST_ACTIVATIONS, MUSCLES

LIMITS = pair_limits(LOWEST_ACTIVATIONS, HIGHEST_ACTIVATIONS)
FIELD_DEG = 45.0

# Signs of adduction, elevation, intorsion that each muscle gives an eye looking straight ahead;
# 0 where anatomy names no action.
ACTIONS = {
    "medial_rectus": (1, 0, 0),
    "lateral_rectus": (-1, 0, 0),
    "superior_rectus": (1, 1, 1),
    "inferior_rectus": (1, -1, -1),
    "superior_oblique": (-1, -1, 1),
    "inferior_oblique": (-1, 1, -1),
}


def k17_rows(maps: Maps | None) -> Iterator[Row]:
    """Gaze and cost of the k17 eyes against OpenEyeSim; nan where that needs its maps."""
    inverse = Inverse(MechanicsConfig())
    inside = (np.linspace(0.0, 0.2, 11), np.linspace(0.0, 0.1, 11))
    everywhere = (np.linspace(0.0, 1.0, 11),) * 2
    for name, (medial, lateral), high in (
        ("gaze map, medial [0, 0.2] x lateral [0, 0.1], rms", inside, 0.15),
        ("gaze map, [0, 1] x [0, 1], rms", everywhere, 2.0),
    ):
        error = math.nan
        if maps is not None:
            gaze = [[0.5 * inverse.vergence_deg(a, b) for b in lateral] for a in medial]
            error = _rms(np.array(gaze) - maps.spline_adduction_deg(medial, lateral))
        yield Row(f"k17: {name}", error, "deg", high=high)
    yield from _k17_cost_rows(maps)
    yield Row("k17: settled by simulation alone", _unsettled_deg(), "deg", high=0.02)
    yield Row("k17: single-muscle points", _single_muscle_error(inverse), "activation", high=0.003)


def _k17_cost_rows(maps: Maps | None) -> Iterator[Row]:
    eyes = Oculomotor(MechanicsConfig())

    def cost_w(medial: float, lateral: float) -> float:
        eyes.settle(eyes.activations_from(medial, lateral))
        return 0.5 * eyes.horizontal_metabolic_rate_w()

    error = math.nan
    if maps is not None:
        grid = [(i, j) for i in range(3) for j in range(2)]
        error = _rms(np.array([cost_w(i / 10, j / 10) / maps.cost_w[i, j] - 1 for i, j in grid]))
    yield Row("k17: cost at OpenEyeSim's six grid points, rms", 100.0 * error, "%", high=3.0)
    between = [(a, b) for a in np.linspace(0, 0.2, 9) for b in np.linspace(0, 0.1, 9)]
    law = max(abs(cost_w(*pair) / power_law_w(*pair) - 1.0) for pair in between)
    yield Row("k17: cost against the power law, worst", 100.0 * law, "%", high=1.0)


def _unsettled_deg() -> float:
    """Distance from the static equilibrium after a control period, nothing but simulated."""
    eyes, reference = Oculomotor(MechanicsConfig()), Oculomotor(MechanicsConfig())
    generator = np.random.default_rng(1)
    worst = 0.0
    for _ in range(100):
        activations = eyes.activations_from(*generator.uniform(0.0, (0.2, 0.1)))
        eyes.advance(activations, eyes.control_period_s)
        reference.settle(activations)
        apart = eyes.state().eye_angles_rad - reference.state().eye_angles_rad
        worst = max(worst, float(np.degrees(np.abs(apart).max())))
    return worst


def _single_muscle_error(inverse: Inverse) -> float:
    worst = 0.0
    baseline_m = MechanicsConfig().baseline_m
    for distance_m, medial, lateral in SINGLE_MUSCLE_POINTS:
        best = inverse.optimal(desired_vergence_deg(distance_m, baseline_m))
        worst = max(worst, abs(best.medial - medial), abs(best.lateral - lateral))
    return worst


def shared_rows(parameter_set: str) -> Iterator[Row]:
    """Rows that both parameter sets have."""
    config = MechanicsConfig(parameter_set=parameter_set)
    generator = np.random.default_rng(0)
    eyes, reference, inverse = Oculomotor(config), Oculomotor(config), Inverse(config)
    inverse_error, unsettled, unlike = 0.0, 0.0, 0.0
    for _ in range(50):
        wanted = generator.uniform(0.535, 9.47)
        pair = inverse.activation_pair(wanted, generator.uniform(), LIMITS)
        reference.settle(reference.activations_from(*pair))
        settled = np.degrees(reference.state().eye_angles_rad)
        inverse_error = max(inverse_error, abs(settled[:, 0].sum() - wanted))
        eyes.step(eyes.activations_from(*pair))
        unsettled = max(unsettled, np.abs(np.degrees(eyes.state().eye_angles_rad) - settled).max())
        reference.settle(np.tile(generator.uniform(0.0, 0.3, 6), 2))
        left, right = np.degrees(reference.state().eye_angles_rad)
        unlike = max(unlike, np.abs(left - right).max())
    yield Row(f"{parameter_set}: inverse then equilibrium", inverse_error, "deg", high=0.01)
    yield Row(f"{parameter_set}: settled after a step", unsettled, "deg", high=0.02)
    yield Row(f"{parameter_set}: left and right eye differ by", unlike, "deg", high=1e-6)
    yield Row(
        f"{parameter_set}: wrong signs among the pulling directions",
        count_wrong_signs(config),
        "",
        high=0.0,
    )


def pulling_directions(config: MechanicsConfig) -> np.ndarray:
    """Torque per unit of force of the left eye's muscles, (6, 3) in mm, looking straight ahead."""
    eyes = Oculomotor(config)
    eyes.data.qpos[:] = 0.0
    mujoco.mj_forward(eyes.model, eyes.data)
    moment_m = np.zeros((eyes.model.nu, eyes.model.nv))
    mujoco.mju_sparse2dense(
        moment_m,
        eyes.data.actuator_moment.reshape(-1),
        eyes.data.moment_rownnz,
        eyes.data.moment_rowadr,
        eyes.data.moment_colind.reshape(-1),
    )
    # A muscle pulls: its force shortens the path, against the moment's sign.
    return -1e3 * moment_m[: len(MUSCLES), :3]


def count_wrong_signs(config: MechanicsConfig) -> float:
    """How many of the six muscles' anatomical actions have the wrong sign."""
    wrong = 0
    for directions, muscle in zip(pulling_directions(config), MUSCLES, strict=True):
        for direction, sign in zip(directions, ACTIONS[muscle], strict=True):
            wrong += sign != 0 and direction * sign <= 0.0
    return float(wrong)


def anatomical_tension_rows() -> Iterator[Row]:
    """Fixation tensions of the anatomical horizontal recti, and torsion in secondary gaze."""
    config = MechanicsConfig(parameter_set="anatomical")
    eyes = Oculomotor(config)
    tension = eyes.state().forces_n / GRAM_FORCE_N
    for i_muscle in (0, 1):
        name = MUSCLES[i_muscle].replace("_", " ")
        yield Row(f"anatomical: {name}, straight ahead", tension[i_muscle], "gf", 8.0, 15.0)
    holding_pair(eyes, FIELD_DEG)
    medial = eyes.state().forces_n[0] / GRAM_FORCE_N
    yield Row("anatomical: medial rectus at 45 deg of adduction", medial, "gf", 30.0, 50.0)
    holding_pair(eyes, -FIELD_DEG)
    lateral = eyes.state().forces_n[1] / GRAM_FORCE_N
    yield Row("anatomical: lateral rectus at 45 deg of abduction", lateral, "gf", 30.0, 50.0)
    torsion = worst_torsion_deg(config)
    yield Row("anatomical: torsion in secondary gaze to 30 deg", torsion, "deg", high=1.0)


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
