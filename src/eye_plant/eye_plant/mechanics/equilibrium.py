"""Where the eyes come to rest: the static equilibrium of the compiled model itself."""

import mujoco
import numpy as np
from numpy.typing import NDArray

from eye_plant.mechanics.compiled import addresses_of, creep_to_rest

Array = NDArray[np.float64]


class Equilibrium:
    """Newton's method on the torques that MuJoCo computes, both eyes at once: `creep_to_rest`."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Work in data, which holds the solution after `solve`."""
        self._kept = model, data
        self._addresses = addresses_of(model, data)
        # Views of what MuJoCo computes, kept: each look-up takes time.
        self._at_rest = data.qvel, data.qacc_warmstart, data.actuator_velocity
        self._muscles = data.ctrl, data.act
        self._angles = data.qpos
        self._forces = data.qfrc_passive, data.qfrc_actuator

    def solve(self, activations: Array, start_rad: Array | None = None) -> None:
        """Put data at rest at the equilibrium of activations (12,); start_rad (6,) speeds it up.

        The search starts at zero angles otherwise, so the result has no history. Angles that find
        no rest within a hundred steps stay where they are then; only muscles that all pull at
        once, at full strength, can bring that about.
        """
        for moving in self._at_rest:
            moving.fill(0.0)
        for activation in self._muscles:
            activation[:] = activations
        self._angles[:] = 0.0 if start_rad is None else start_rad
        creep_to_rest(self._addresses, self._forces, self._angles)
