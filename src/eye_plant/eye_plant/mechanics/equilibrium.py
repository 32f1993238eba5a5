"""Where the eyes come to rest: the static equilibrium of the compiled model itself."""

import mujoco
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_PROBE_RAD = 1e-6
_REACH_RAD = 0.2
_CONVERGED_RAD = 1e-13
_MAX_ITERATIONS = 100


class Equilibrium:
    """Newton's method on the torques that MuJoCo computes, both eyes at once.

    K being the stiffness and t the torque, a step solves (K + |t| / reach) step = t: an implicit
    Euler step of eyes in honey, whose length stays below the reach. So the search follows the
    way the eyes would creep, to the equilibrium they would find, and ends as Newton's method does.
    The eyes share no tissue, so one evaluation probes the same axis of both.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Work in data, which holds the solution after `solve`."""
        self._model = model
        self._data = data
        # Views of what MuJoCo computes, kept: each look-up takes time, and there are dozens a step.
        self._angles = data.qpos
        self._passive, self._active = data.qfrc_passive, data.qfrc_actuator

    def solve(self, activations: Array, start_rad: Array | None = None) -> None:
        """Put data at rest at the equilibrium of activations (12,); start_rad (6,) speeds it up.

        The search starts at zero angles otherwise, so the result has no history. Angles that find
        no rest within a hundred steps stay where they are then; only muscles that all pull at
        once, at full strength, can bring that about.
        """
        data = self._data
        data.qvel[:] = 0.0
        data.qacc_warmstart[:] = 0.0
        data.ctrl[:] = activations
        data.act[:] = activations
        self._angles[:] = 0.0 if start_rad is None else start_rad
        for _ in range(_MAX_ITERATIONS):
            step = self._creep(self.torque())
            self._angles += step
            if np.abs(step).max() < _CONVERGED_RAD:
                break
        mujoco.mj_forward(self._model, data)

    def torque(self) -> Array:
        """Net torque (6,) about the joints, in N m, at the present angles."""
        mujoco.mj_fwdPosition(self._model, self._data)
        mujoco.mj_fwdVelocity(self._model, self._data)
        mujoco.mj_fwdActuation(self._model, self._data)
        return self._passive + self._active

    def stiffness(self, torque: Array) -> Array:
        """Return -d torque / d angle, (2, 3, 3) in N m / rad, by differences from torque (6,)."""
        angles = self._angles.copy()
        columns = np.empty((2, 3, 3))
        for i_axis in range(3):
            self._angles[:] = angles
            self._angles[i_axis::3] += _PROBE_RAD
            columns[:, :, i_axis] = ((torque - self.torque()) / _PROBE_RAD).reshape(2, 3)
        self._angles[:] = angles
        return columns

    def _creep(self, torque: Array) -> Array:
        """Return the next step (6,), each eye's slowed by its own torque."""
        resisting = self.stiffness(torque)
        torques = torque.reshape(2, 3, 1)
        resisting += np.abs(torques).max(axis=1, keepdims=True) / _REACH_RAD * np.eye(3)
        step = np.empty(6)
        step[:] = np.linalg.solve(resisting, torques).reshape(6)
        return step
