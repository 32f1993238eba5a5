"""The twelve muscles' parameters as arrays, and the energetics of their simulated state."""

import numpy as np
from numpy.typing import NDArray

from eye_plant.mechanics.metabolics import MetabolicTerms, metabolic_terms, settled_rate_w
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from eye_plant.mechanics.muscles import force_length, passive_force_length
from lockstep import SIDES
from lockstep.command_space import MUSCLES

Array = NDArray[np.float64]


class Musculature:
    """Parameters of the muscles, (12,) each in MUSCLE_NAMES' order."""

    def __init__(self, config: MechanicsConfig) -> None:
        """Lay out the parameter set's muscles, left before right."""
        muscles = [config.parameters.muscles[name] for _ in SIDES for name in MUSCLES]
        self._energetics = config.parameters.energetics
        self.tonic_activation = np.array([muscle.tonic_activation for muscle in muscles])
        self.peak_force_n = np.array([muscle.peak_force_n for muscle in muscles])
        self.optimal_length_m = np.array([muscle.optimal_length_m for muscle in muscles])
        self.slack_length_m = np.array([muscle.slack_length_m for muscle in muscles])
        self.max_velocity_per_s = np.array([muscle.max_velocity_per_s for muscle in muscles])
        self.mass_kg = np.array([muscle.mass_kg for muscle in muscles])
        self.shortest = np.array([muscle.shortest for muscle in muscles])
        self.longest = np.array([muscle.longest for muscle in muscles])
        self.passive_stiffness = np.array([muscle.passive_stiffness for muscle in muscles])

    def fibre_lengths(self, path_lengths_m: Array) -> Array:
        """Return fibre lengths (..., 12) in optimal lengths of paths (..., 12); rigid tendons."""
        return (path_lengths_m - self.slack_length_m) / self.optimal_length_m

    def passive_forces_n(self, path_lengths_m: Array) -> Array:
        """Pull (..., 12) of the unexcited muscles at path lengths (..., 12)."""
        lengths = self.fibre_lengths(path_lengths_m)
        return self.peak_force_n * passive_force_length(
            lengths, self.longest, self.passive_stiffness
        )

    def metabolic_terms(
        self,
        excitations: Array,
        activations: Array,
        path_lengths_m: Array,
        velocities_m_s: Array,
        forces_n: Array,
    ) -> MetabolicTerms:
        """Umberger's terms, (..., 12) each, of the muscles' state; forces_n: whole pull."""
        lengths = self.fibre_lengths(path_lengths_m)
        return metabolic_terms(
            excitation=excitations,
            activation=activations,
            length=lengths,
            velocity_per_s=velocities_m_s / self.optimal_length_m,
            isometric_force=force_length(lengths, self.shortest, self.longest),
            contractile_force_n=forces_n - self.passive_forces_n(path_lengths_m),
            optimal_length_m=self.optimal_length_m,
            max_velocity_per_s=self.max_velocity_per_s,
            mass_kg=self.mass_kg,
            energetics=self._energetics,
        )

    def settled_rate_w(self, activations: Array, path_lengths_m: Array) -> Array:
        """Metabolic rate (12,) of muscles that neither move nor change their activation."""
        lengths = self.fibre_lengths(path_lengths_m)
        isometric_force = np.ones_like(lengths)
        if self._energetics.length_dependent:
            isometric_force = force_length(lengths, self.shortest, self.longest)
        rates_w: Array = settled_rate_w(
            activations, lengths, isometric_force, self.mass_kg, *self._energetics
        )
        return rates_w
