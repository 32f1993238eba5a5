"""The moving eyes: settle, step, read out. One `Oculomotor` owns one MuJoCo simulation."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from eye_plant.mechanics.compiled import addresses_of, creep_to_rest, step_and_trace
from eye_plant.mechanics.metabolics import MetabolicTerms
from eye_plant.mechanics.mujoco_model import AXES, N_MUSCLES, MechanicsConfig, build_spec
from eye_plant.mechanics.muscle_energetics import Musculature
from lockstep import SIDES, InputError

Array = NDArray[np.float64]

# Positions of the horizontal recti among the twelve muscles, left before right.
MEDIAL = np.array([0, 6])
LATERAL = np.array([1, 7])
_HORIZONTAL = np.array([0, 1, 6, 7])

# Of a quotient of two durations, so that three periods of 0.1 s are not four steps.
_ROUNDING = 1e-9


@dataclass(frozen=True)
class OculomotorState:
    """What the eyes and muscles are doing; the arrays are copies.

    eye_angles_rad, eye_velocities_rad_s: (2, 3), left and right eye by adduction, elevation,
    intorsion. The others are (12,) in MUSCLE_NAMES' order: activations; lengths_m and
    velocities_m_s of the whole path, shortening negative; forces_n, pull positive;
    metabolic_rate_w as if settled, mean_metabolic_rate_w over the last control period; few ask for
    that one, so it is computed for them.
    """

    eye_angles_rad: Array
    eye_velocities_rad_s: Array
    activations: Array
    lengths_m: Array
    velocities_m_s: Array
    forces_n: Array
    metabolic_rate_w: Array
    compute_mean_rate_w: Callable[[], Array]

    @property
    def mean_metabolic_rate_w(self) -> Array:
        """Metabolic rate (12,) with transients and work, the mean over the last control period."""
        return self.compute_mean_rate_w()


class Oculomotor:
    """Two eyes with six muscles each, in the order of MUSCLE_NAMES.

    What a `step` does depends on the settled state and the steps since, on nothing else; the same
    calls give the same bits.
    """

    def __init__(self, config: MechanicsConfig) -> None:
        """Build the eyes, at rest at tonic activations."""
        self._take(config, build_spec(config).compile())
        self.model.opt.timestep = config.period_s / self._n_substeps
        self._forget_trace()
        self.settle(self.tonic_activations)

    def _take(
        self, config: MechanicsConfig, model: mujoco.MjModel, data: mujoco.MjData | None = None
    ) -> None:
        self.config, self.model = config, model
        self.data = data = mujoco.MjData(model) if data is None else data
        self.musculature = Musculature(config)
        self._addresses = addresses_of(model, data)
        # Views, kept: each look-up takes time.
        self._live = (data.act, data.actuator_length, data.actuator_velocity, data.actuator_force)
        self._angles, self._velocities = data.qpos, data.qvel
        self._forces = data.qfrc_passive, data.qfrc_actuator
        self._muscles = data.ctrl, data.act
        self._at_rest = data.qvel, data.qacc_warmstart, data.actuator_velocity
        self._i_eyes = [model.body(f"{side}_eye").id for side in SIDES]
        self._positions_m, self._rotations = data.xpos, data.xmat
        self._timestep_s = config.timestep_s or config.parameters.timestep_s
        self._n_substeps = max(1, round(config.period_s / self._timestep_s))
        self._n_simulated = 0 if config.moves == "at_once" else self._n_substeps

    def __getstate__(self) -> tuple[Any, ...]:
        """Copy and pickle without addresses and views, which are of one simulation."""
        return self.config, self.model, self.data, self._trace, self._excitations

    def __setstate__(self, state: tuple[Any, ...]) -> None:
        """Look into the simulation of the copy."""
        *simulation, self._trace, self._excitations = state
        self._take(*simulation)

    @property
    def tonic_activations(self) -> Array:
        """Activations (12,) of muscles that nobody commands."""
        return self.musculature.tonic_activation.copy()

    @property
    def control_period_s(self) -> float:
        """Simulated time that one `step` takes."""
        return float(self._n_substeps * self.model.opt.timestep)

    def activations_from(self, medial: float, lateral: float) -> Array:
        """Activations (12,): both eyes' horizontal recti as given, the others at tonic level."""
        activations = self.tonic_activations
        activations[MEDIAL] = medial
        activations[LATERAL] = lateral
        return activations

    def settle(self, activations: Array) -> None:
        """Forget everything and jump to the static equilibrium at activations (12,)."""
        self.rest(check_activations(activations))
        self.data.time = 0.0
        self._forget_trace()

    def rest(self, activations: Array, start_rad: Array | None = None) -> None:
        """Put data at rest at the static equilibrium of activations (12,), which are not checked.

        start_rad: angles (6,) near it, to be faster. The search starts at zero angles otherwise, so
        the result has no history. Angles that find no rest within a hundred steps stay where they
        are then; only muscles that all pull at once, at full strength, can bring that about.
        """
        for moving in self._at_rest:
            moving.fill(0.0)
        for activation in self._muscles:
            activation[:] = activations
        self._angles[:] = 0.0 if start_rad is None else start_rad
        creep_to_rest(self._addresses, self._forces, self._angles)

    def step(self, activations: Array) -> None:
        """Spend one control period on the way to the target activations (12,); ends settled.

        The period is simulated; what would still creep after it is taken at once, so that the
        eyes rest at the static equilibrium that they were on their way to (D1). Of eyes whose
        moves are at_once nothing is simulated, and they rest at the same place.
        """
        activations = check_activations(activations)
        self.data.ctrl[:] = activations
        # A new one each time: states of before may still want theirs.
        self._trace = np.empty((self._n_simulated, len(self._live), N_MUSCLES))
        self._excitations = activations.copy()
        step_and_trace(self._addresses, self._trace, self._live)
        self.rest(activations, self._angles)

    def state(self) -> OculomotorState:
        """Copies of the present state."""
        activations, lengths_m, velocities_m_s, forces_n = self._live
        settled_w = self.settled_metabolic_rate_w()
        return OculomotorState(
            eye_angles_rad=self._angles.reshape(len(SIDES), len(AXES)).copy(),
            eye_velocities_rad_s=self._velocities.reshape(len(SIDES), len(AXES)).copy(),
            activations=activations.copy(),
            lengths_m=lengths_m.copy(),
            velocities_m_s=velocities_m_s.copy(),
            forces_n=-forces_n,
            metabolic_rate_w=settled_w,
            compute_mean_rate_w=partial(
                _mean_rate_w, self.musculature, self._trace, self._excitations, settled_w
            ),
        )

    def settled_metabolic_rate_w(self) -> Array:
        """Metabolic rate (12,) of the muscles as they are, were they to stay so."""
        return self.musculature.settled_rate_w(*self._live[:2])

    def horizontal_metabolic_rate_w(self) -> float:
        """Return what the four horizontal recti take together, settled."""
        return float(self.settled_metabolic_rate_w()[_HORIZONTAL].sum())

    def advance(self, activations: Array, duration_s: float) -> None:
        """Simulate towards the target activations (12,) without waiting for the eyes to settle.

        duration_s, above 0, is met exactly: by the fewest equal time steps that are none of them
        longer than the configured one.
        """
        self.data.ctrl[:] = check_activations(activations)
        own_timestep_s = self.model.opt.timestep
        n_substeps = max(1, math.ceil(duration_s / self._timestep_s * (1.0 - _ROUNDING)))
        self.model.opt.timestep = duration_s / n_substeps
        mujoco.mj_step(self.model, self.data, n_substeps)
        mujoco.mj_forward(self.model, self.data)
        self.model.opt.timestep = own_timestep_s
        self._forget_trace()

    def metabolic_trace(self) -> MetabolicTerms:
        """Umberger's terms, (n, 12) each, over the n substeps of the last control period."""
        return _metabolic_terms(self.musculature, self._trace, self._excitations)

    def _forget_trace(self) -> None:
        self._trace = np.empty((0, len(self._live), N_MUSCLES))
        self._excitations = self.tonic_activations

    def eye_positions_m(self) -> Array:
        """Centres of the eyes, (2, 3), in the world frame: x forward, y left, z up."""
        return self._positions_m[self._i_eyes]

    def eye_rotations(self) -> Array:
        """Rotation matrices of the eyes, (2, 3, 3): columns are forward, left and up of an eye."""
        return self._rotations[self._i_eyes].reshape(len(SIDES), 3, 3)


def _metabolic_terms(muscles: Musculature, trace: Array, excitations: Array) -> MetabolicTerms:
    activations, lengths_m, velocities_m_s, forces_n = trace.swapaxes(0, 1)
    return muscles.metabolic_terms(excitations, activations, lengths_m, velocities_m_s, -forces_n)


def _mean_rate_w(muscles: Musculature, trace: Array, excitations: Array, settled_w: Array) -> Array:
    """Return the mean rate (12,) over a trace, the settled one where nothing was simulated."""
    if not len(trace):
        return settled_w
    return _metabolic_terms(muscles, trace, excitations).total_w.mean(axis=0)


def check_activations(activations: Array) -> Array:
    """Return activations as floats, or raise InputError unless (12,) within [0, 1]."""
    activations = np.asarray(activations, dtype=np.float64)
    if activations.shape != (N_MUSCLES,):
        raise InputError(f"expected {N_MUSCLES} activations, got shape {activations.shape}")
    if not bool(np.all((activations >= 0.0) & (activations <= 1.0))):
        raise InputError(f"activations: expected 0 to 1, got {activations.tolist()}")
    return activations
