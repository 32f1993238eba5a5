"""Metabolic rate of a muscle, after Umberger, Gerritsen & Martin (2003).

All rates are per muscle, in W. Velocities are in optimal fibre lengths per second, shortening
negative, as in the paper.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

# Umberger 2003, eq. 7: activation and maintenance heat of slow and of additional fast fibres.
SLOW_HEAT_W_PER_KG = 25.0
FAST_HEAT_W_PER_KG = 128.0
# Umberger 2003, eqs. 9-11: heat of shortening at the highest velocity of each fibre type.
SLOW_SHORTENING_W_PER_KG = 100.0
FAST_SHORTENING_W_PER_KG = 153.0
# Umberger 2003: slow fibres shorten at most 1 / 2.5 as fast as the fast ones.
FAST_TO_SLOW_VELOCITY = 2.5
LENGTHENING_FACTOR = 4.0
MINIMUM_HEAT_W_PER_KG = 1.0


@dataclass(frozen=True)
class Energetics:
    """What the heat of a muscle depends on besides its state.

    scaling: 1.0 anaerobic, 1.5 aerobic (Umberger 2003, S); fast_fraction: share of fast fibres;
    minimum_activation: floor of the activation that is charged, not of the muscle's own;
    length_dependent: whether heat falls with the isometric force above the optimal length.
    """

    scaling: float = 1.0
    fast_fraction: float = 0.8
    minimum_activation: float = 0.0
    length_dependent: bool = True


@dataclass(frozen=True)
class MetabolicTerms:
    """The parts of the metabolic rate, each of the shape of the inputs, in W.

    floor: what is added where the heat would fall below 1 W/kg; work: negative while the muscle
    is stretched.
    """

    activation_maintenance_w: Array
    shortening_lengthening_w: Array
    floor_w: Array
    work_w: Array

    @property
    def total_w(self) -> Array:
        """Metabolic rate: heat and work."""
        heat = self.activation_maintenance_w + self.shortening_lengthening_w + self.floor_w
        return heat + self.work_w


def activation_maintenance_w_per_kg(
    activation: ArrayLike, isometric_force: ArrayLike, energetics: Energetics
) -> Array:
    """Heat of activation and maintenance, S A^0.6 h_AM (Umberger 2003, eqs. 7 and 8).

    isometric_force: fraction of the peak force that is left above the optimal length, 1 below;
    it scales the 60 % of the heat that is maintenance.
    """
    heat_w_per_kg = FAST_HEAT_W_PER_KG * energetics.fast_fraction + SLOW_HEAT_W_PER_KG
    share = 0.4 + 0.6 * np.asarray(isometric_force)
    return energetics.scaling * np.asarray(activation) ** 0.6 * heat_w_per_kg * share


def shortening_lengthening_w_per_kg(
    activation: ArrayLike,
    velocity_per_s: ArrayLike,
    max_velocity_per_s: ArrayLike,
    isometric_force: ArrayLike,
    energetics: Energetics,
) -> Array:
    """Heat of shortening or lengthening (Umberger 2003, eqs. 9 to 12).

    velocity_per_s: optimal lengths per second, shortening negative; max_velocity_per_s > 0.
    """
    activation = np.asarray(activation)
    speed = np.abs(velocity_per_s)
    fast = energetics.fast_fraction
    per_slow = SLOW_SHORTENING_W_PER_KG * FAST_TO_SLOW_VELOCITY / np.asarray(max_velocity_per_s)
    per_fast = FAST_SHORTENING_W_PER_KG / np.asarray(max_velocity_per_s)
    slow_heat = np.minimum(per_slow * speed, SLOW_SHORTENING_W_PER_KG) * (1.0 - fast)
    shortening = activation**2 * (slow_heat + per_fast * speed * fast)
    lengthening = activation * LENGTHENING_FACTOR * per_slow * speed
    heat = np.where(np.asarray(velocity_per_s) <= 0.0, shortening, lengthening)
    return energetics.scaling * heat * np.asarray(isometric_force)


def settled_rate_w(
    *,
    activation: ArrayLike,
    length: ArrayLike,
    isometric_force: ArrayLike,
    mass_kg: ArrayLike,
    energetics: Energetics,
) -> Array:
    """Metabolic rate of muscles that neither move nor change their activation."""
    charged = np.maximum(activation, energetics.minimum_activation)
    left = _force_left(length, isometric_force, energetics)
    heat = activation_maintenance_w_per_kg(charged, left, energetics)
    return np.maximum(heat, MINIMUM_HEAT_W_PER_KG) * np.asarray(mass_kg)


def _force_left(length: ArrayLike, isometric_force: ArrayLike, energetics: Energetics) -> Array:
    """Isometric force above the optimal length, 1 below it or where length does not count."""
    above = energetics.length_dependent & (np.asarray(length) > 1.0)
    return np.where(above, isometric_force, 1.0)


def metabolic_terms(
    *,
    excitation: ArrayLike,
    activation: ArrayLike,
    length: ArrayLike,
    velocity_per_s: ArrayLike,
    isometric_force: ArrayLike,
    contractile_force_n: ArrayLike,
    optimal_length_m: ArrayLike,
    max_velocity_per_s: ArrayLike,
    mass_kg: ArrayLike,
    energetics: Energetics,
) -> MetabolicTerms:
    """Metabolic rate of muscles from their state; all inputs broadcast against one another.

    A = u where u > a, else (u + a) / 2 (Umberger 2003, eq. 6), not below the charged minimum.
    length: fibre length in optimal lengths; isometric_force: FL at that length;
    contractile_force_n: force of the active fibres alone, pull positive.
    """
    excitation, activation = np.asarray(excitation), np.asarray(activation)
    charged = np.where(excitation > activation, excitation, 0.5 * (excitation + activation))
    charged = np.maximum(charged, energetics.minimum_activation)
    left = _force_left(length, isometric_force, energetics)
    maintenance = activation_maintenance_w_per_kg(charged, left, energetics)
    sliding = shortening_lengthening_w_per_kg(
        charged, velocity_per_s, max_velocity_per_s, left, energetics
    )
    mass_kg = np.asarray(mass_kg)
    velocity_m_s = np.asarray(velocity_per_s) * np.asarray(optimal_length_m)
    return MetabolicTerms(
        activation_maintenance_w=maintenance * mass_kg,
        shortening_lengthening_w=sliding * mass_kg,
        floor_w=np.maximum(MINIMUM_HEAT_W_PER_KG - maintenance - sliding, 0.0) * mass_kg,
        work_w=-np.asarray(contractile_force_n) * velocity_m_s,
    )
