"""Eyes that nothing drives and nothing damps keep their energy: a check of the mechanics itself."""

import math

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from eye_plant.mechanics.mujoco_model import MechanicsConfig, build_spec
from eye_plant.mechanics.muscle_energetics import Musculature

_START_RAD = 0.2
_STEPS_PER_RADIAN = 20.0
_N_SAMPLES = 100


@pytest.mark.parametrize("parameter_set", ["k17", "anatomical"])
def test_a_passive_swing_exchanges_its_energy_and_keeps_it(parameter_set: str) -> None:
    config = MechanicsConfig(parameter_set=parameter_set)
    energy_j, kinetic_j = _swing(config, duration_s=0.2)
    np.testing.assert_allclose(energy_j, energy_j[0], rtol=1e-4)
    assert kinetic_j[0] == 0.0
    assert kinetic_j.max() > 0.1 * energy_j[0]
    if parameter_set == "anatomical":
        # 0.2 rad off on each of six axes, tissue alone: 6 (k1 x^2 / 2 + k3 x^4 / 4)
        expected_j = 6.0 * (2.225e-3 * 0.04 / 2.0 + 3.453e-3 * 0.0016 / 4.0)
        assert energy_j[0] == pytest.approx(expected_j, rel=0.05)


def _swing(config: MechanicsConfig, duration_s: float) -> tuple[NDArray, NDArray]:
    """Return whole and kinetic energy, (101,) each, over a free swing from 0.2 rad on each axis.

    Silent muscles, no damping, Runge-Kutta steps of a twentieth of the fastest swing's radian.
    """
    orbit, musculature = config.parameters.orbit, Musculature(config)
    model = build_spec(config).compile()
    model.dof_damping[:] = 0.0
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    stiffest_n_m = max(k1 + 3.0 * k3 for k1, _, k3 in orbit.stiffness_n_m)
    fastest_rad_s = math.sqrt(stiffest_n_m / orbit.globe_inertia_kg_m2)
    n_steps = math.ceil(duration_s * fastest_rad_s * _STEPS_PER_RADIAN / _N_SAMPLES)
    model.opt.timestep = duration_s / (n_steps * _N_SAMPLES)
    data = mujoco.MjData(model)
    data.qpos[:] = _START_RAD
    kinetic_j, elastic_j = np.empty((2, _N_SAMPLES + 1))
    for i in range(_N_SAMPLES + 1):
        if i:
            mujoco.mj_step(model, data, n_steps)
        mujoco.mj_forward(model, data)
        # A globe's inertia is the same about any axis.
        speeds_rad_s = [data.body(f"{side}_eye").cvel[:3] for side in ("left", "right")]
        kinetic_j[i] = 0.5 * orbit.globe_inertia_kg_m2 * np.sum(np.square(speeds_rad_s))
        elastic_j[i] = _orbit_j(config, data.qpos) + _muscles_j(musculature, data.actuator_length)
    return kinetic_j + elastic_j, kinetic_j


def _orbit_j(config: MechanicsConfig, angles_rad: NDArray) -> float:
    """Return the integral of the orbit's cubic polynomial over each angle."""
    orbit, energy_j = config.parameters.orbit, 0.0
    for i, angle in enumerate(angles_rad):
        k1, k2, k3 = orbit.stiffness_n_m[i % 3]
        x = float(angle) - orbit.rest_rad[i % 3]
        energy_j += k1 * x**2 / 2.0 + k2 * x**3 / 3.0 + k3 * x**4 / 4.0
    return energy_j


def _muscles_j(muscles: Musculature, path_lengths_m: NDArray) -> float:
    """Return the integral of the passive pull of twelve muscles at these lengths (12,)."""
    half = 0.5 * (muscles.longest - 1.0)
    stretch = np.maximum(muscles.fibre_lengths(path_lengths_m) - 1.0, 0.0) / half
    over = np.maximum(stretch - 1.0, 0.0)
    parabola = np.minimum(stretch, 1.0) ** 3 / 6.0
    area = (parabola + 0.5 * over + 0.5 * over**2) * half * muscles.passive_stiffness
    return float(np.sum(muscles.peak_force_n * muscles.optimal_length_m * area))
