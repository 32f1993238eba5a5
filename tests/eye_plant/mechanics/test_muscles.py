import mujoco
import numpy as np
import pytest

from eye_plant.mechanics.mujoco_model import MechanicsConfig, build_spec
from eye_plant.mechanics.muscles import force_length, passive_force_length
from lockstep import MUSCLE_NAMES

SHORTEST, LONGEST, STIFFNESS = 0.4, 1.7, 0.6
UNIT = np.array([0.0, 1.0])


def mujoco_parameters(shortest: float, longest: float, stiffness: float, gain: float) -> np.ndarray:
    """Return range, force, scale, lmin, lmax, vmax, fpmax, fvmax of mju_muscleGain."""
    return np.array([0.0, 1.0, 1.0, 1.0, shortest, longest, 1.0, stiffness, gain])


@pytest.mark.parametrize(
    ("curve", "parameters", "points"),
    [
        (
            force_length,
            (SHORTEST, LONGEST),
            {0.4: 0, 0.55: 0.125, 0.7: 0.5, 1: 1, 1.35: 0.5, 1.7: 0},
        ),
        (passive_force_length, (LONGEST, STIFFNESS), {0.9: 0, 1.175: 0.075, 1.35: 0.3, 1.7: 0.9}),
    ],
)
def test_curves_at_points_worked_out_by_hand(curve, parameters, points):
    for at, expected in points.items():
        assert curve(float(at), *parameters) == pytest.approx(expected, abs=1e-12)


def test_curves_are_those_that_mujoco_simulates():
    parameters = mujoco_parameters(SHORTEST, LONGEST, STIFFNESS, 1.3)
    for length in np.linspace(0.3, 1.9, 33):
        gain = mujoco.mju_muscleGain(length, 0.0, UNIT, 1.0, parameters)
        assert force_length(length, SHORTEST, LONGEST) == pytest.approx(-gain, abs=1e-12)
        bias = mujoco.mju_muscleBias(length, UNIT, 1.0, parameters)
        assert passive_force_length(length, LONGEST, STIFFNESS) == pytest.approx(-bias, abs=1e-12)


@pytest.mark.parametrize("parameter_set", ["k17", "anatomical"])
def test_simulated_pull_is_the_hill_formula_of_the_parameters(parameter_set):
    config = MechanicsConfig(parameter_set=parameter_set)
    model = build_spec(config).compile()
    data = mujoco.MjData(model)
    generator = np.random.default_rng(1)
    data.act[:] = generator.uniform(0.0, 1.0, 12)
    data.qpos[:] = generator.uniform(-0.4, 0.4, 6)
    data.qvel[:] = generator.uniform(-3.0, 3.0, 6)
    mujoco.mj_forward(model, data)
    for i, name in enumerate(MUSCLE_NAMES):
        muscle = config.parameters.muscles[name.split("_", 1)[1]]
        length = (data.actuator_length[i] - muscle.slack_length_m) / muscle.optimal_length_m
        velocity = data.actuator_velocity[i] / muscle.optimal_length_m / muscle.max_velocity_per_s
        parameters = mujoco_parameters(
            muscle.shortest, muscle.longest, muscle.passive_stiffness, muscle.lengthening_gain
        )
        active = -data.act[i] * mujoco.mju_muscleGain(length, velocity, UNIT, 1.0, parameters)
        passive = passive_force_length(length, muscle.longest, muscle.passive_stiffness)
        expected_n = muscle.peak_force_n * (active + passive)
        assert -data.actuator_force[i] == pytest.approx(expected_n, rel=1e-9, abs=1e-12)
