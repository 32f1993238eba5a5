"""Energy of eyes that nothing drives and nothing damps: a check of the mechanics itself."""

import math

import mujoco
import numpy as np
from numpy.typing import NDArray

from eye_plant.mechanics.model import MechanicsConfig, build_spec
from eye_plant.mechanics.musculature import Musculature

Array = NDArray[np.float64]

_STEPS_PER_RADIAN = 20.0
_START_RAD = 0.2
_N_SAMPLES = 100


def passive_energy_j(config: MechanicsConfig, duration_s: float) -> Array:
    """Kinetic and elastic energy, (101,), over a free swing from 0.2 rad off on each axis.

    Silent muscles, no damping, Runge-Kutta steps of a twentieth of the fastest swing's radian.
    Elastic energy: the orbit's polynomial and the passive muscles' force, each integrated.
    """
    parameters, musculature = config.parameters, Musculature(config)
    model = build_spec(config).compile()
    model.dof_damping[:] = 0.0
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    stiffness_n_m = max(k1 + 3.0 * k3 for k1, _, k3 in parameters.orbit.stiffness_n_m)
    frequency_rad_s = math.sqrt(stiffness_n_m / parameters.orbit.globe_inertia_kg_m2)
    n_steps = math.ceil(duration_s * frequency_rad_s * _STEPS_PER_RADIAN / _N_SAMPLES)
    model.opt.timestep = duration_s / (n_steps * _N_SAMPLES)
    data = mujoco.MjData(model)
    data.qpos[:] = _START_RAD
    energies_j = np.empty(_N_SAMPLES + 1)
    for i_sample in range(_N_SAMPLES + 1):
        if i_sample:
            mujoco.mj_step(model, data, n_steps)
        mujoco.mj_forward(model, data)
        kinetic_j = 0.5 * parameters.orbit.globe_inertia_kg_m2 * _speed_squared(data)
        orbit_j = _orbit_energy_j(config, data.qpos)
        energies_j[i_sample] = (
            kinetic_j + orbit_j + musculature.passive_energy_j(data.actuator_length)
        )
    return energies_j


def _speed_squared(data: mujoco.MjData) -> float:
    """Sum of both eyes' squared angular velocities; a globe's inertia is the same on any axis."""
    return sum(float(np.sum(data.body(f"{side}_eye").cvel[:3] ** 2)) for side in ("left", "right"))


def _orbit_energy_j(config: MechanicsConfig, angles_rad: Array) -> float:
    orbit = config.parameters.orbit
    energy_j = 0.0
    for i, angle in enumerate(angles_rad):
        k1, k2, k3 = orbit.stiffness_n_m[i % 3]
        x = float(angle) - orbit.rest_rad[i % 3]
        energy_j += k1 * x**2 / 2.0 + k2 * x**3 / 3.0 + k3 * x**4 / 4.0
    return energy_j
