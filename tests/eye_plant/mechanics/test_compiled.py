"""MuJoCo's functions in compiled loops, against the same functions called from Python."""

import mujoco
import numpy as np
import pytest

from eye_plant.mechanics.compiled import addresses_of, creep_to_rest, step_and_trace
from eye_plant.mechanics.mujoco_model import MechanicsConfig, build_spec


@pytest.fixture(params=["k17", "anatomical"])
def model(request: pytest.FixtureRequest) -> mujoco.MjModel:
    return build_spec(MechanicsConfig(parameter_set=request.param)).compile()


def test_the_trace_is_that_of_single_steps(model: mujoco.MjModel) -> None:
    compiled, plain = mujoco.MjData(model), mujoco.MjData(model)
    commands = np.linspace(0.0, 0.4, 12)
    trace = np.empty((30, 4, 12))
    compiled.ctrl[:] = plain.ctrl[:] = commands
    live = (
        compiled.act,
        compiled.actuator_length,
        compiled.actuator_velocity,
        compiled.actuator_force,
    )
    step_and_trace(addresses_of(model, compiled), trace, live)
    for activations, lengths_m, velocities_m_s, forces_n in trace:
        np.testing.assert_array_equal(activations, plain.act)
        mujoco.mj_step(model, plain)
        np.testing.assert_array_equal(lengths_m, plain.actuator_length)
        np.testing.assert_array_equal(velocities_m_s, plain.actuator_velocity)
        np.testing.assert_array_equal(forces_n, plain.actuator_force)
    np.testing.assert_array_equal(compiled.qpos, plain.qpos)


def test_nothing_accelerates_at_rest(model: mujoco.MjModel) -> None:
    data = mujoco.MjData(model)
    random = np.random.default_rng(4)
    for _ in range(50):
        data.act[:] = data.ctrl[:] = random.uniform(0.0, 0.5, 12)
        data.qpos[:] = 0.0
        creep_to_rest(addresses_of(model, data), (data.qfrc_passive, data.qfrc_actuator), data.qpos)
        angles_rad = data.qpos.copy()
        mujoco.mj_forward(model, data)
        torque_n_m = data.qfrc_passive + data.qfrc_actuator
        # Against the orbital tissue alone, a torque of one part in 10^12 of its stiffness.
        assert np.abs(torque_n_m).max() < 1e-12 * model.jnt_stiffness.max()
        np.testing.assert_array_equal(data.qpos, angles_rad)
