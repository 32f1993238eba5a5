"""Metabolic rate of a muscle, after Umberger, Gerritsen & Martin (2003).

All rates are per muscle, in W. Velocities are in optimal fibre lengths per second, shortening
negative, as in the paper.
"""

from dataclasses import dataclass

import numpy as np
from numba import bool_, float64, njit, void
from numpy.typing import ArrayLike, NDArray

from eye_plant.mechanics.parameters import Energetics

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


def silent_activation(energetics: Energetics) -> float:
    """Activation below which the cost of a muscle at its optimal length no longer falls.

    Either the charged minimum, or where S A^0.6 h_AM falls below the least heat, 1 W/kg.
    """
    full_w_per_kg = energetics.scaling * (
        FAST_HEAT_W_PER_KG * energetics.fast_fraction + SLOW_HEAT_W_PER_KG
    )
    least = (MINIMUM_HEAT_W_PER_KG / full_w_per_kg) ** (1.0 / 0.6)
    return max(energetics.minimum_activation, float(least))


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
    inputs = np.broadcast_arrays(
        excitation,
        activation,
        length,
        velocity_per_s,
        isometric_force,
        contractile_force_n,
        optimal_length_m,
        max_velocity_per_s,
        mass_kg,
    )
    state = np.array(inputs, dtype=np.float64)
    terms_w = np.empty((4, *state.shape[1:]))
    _fill_terms_w(state.reshape(len(state), -1), *energetics, terms_w.reshape(len(terms_w), -1))
    return MetabolicTerms(*terms_w)


@njit(cache=True)
def _maintenance_w_per_kg(activation, left, scaling, fast):  # type: ignore[no-untyped-def]
    """Heat of activation and maintenance, S A^0.6 h_AM (Umberger 2003, eqs. 7 and 8).

    left: fraction of the peak force that is left above the optimal length, 1 below; it scales the
    60 % of the heat that is maintenance.
    """
    heat_w_per_kg = FAST_HEAT_W_PER_KG * fast + SLOW_HEAT_W_PER_KG
    return scaling * activation**0.6 * heat_w_per_kg * (0.4 + 0.6 * left)


@njit(cache=True)
def _sliding_w_per_kg(activation, velocity, max_velocity, scaling, fast):  # type: ignore[no-untyped-def]
    """Heat of shortening or lengthening at full isometric force (Umberger 2003, eqs. 9 to 12).

    velocity: optimal lengths per second, shortening negative; max_velocity > 0.
    """
    speed = abs(velocity)
    per_slow = SLOW_SHORTENING_W_PER_KG * FAST_TO_SLOW_VELOCITY / max_velocity
    if velocity > 0.0:
        return scaling * activation * LENGTHENING_FACTOR * per_slow * speed
    per_fast = FAST_SHORTENING_W_PER_KG / max_velocity
    slow_heat = min(per_slow * speed, SLOW_SHORTENING_W_PER_KG) * (1.0 - fast)
    return scaling * activation**2 * (slow_heat + per_fast * speed * fast)


@njit(
    float64[::1](*(float64[:],) * 4, float64, float64, float64, bool_),
    cache=True,
)
def settled_rate_w(  # type: ignore[no-untyped-def]  # noqa: PLR0917 (all fields of Energetics)
    activations, lengths, isometric_forces, masses_kg, scaling, fast, minimum, length_dependent
):
    """Metabolic rate (n,) of muscles (n,) that neither move nor change their activation."""
    rates_w = np.empty(len(activations))
    for i in range(len(activations)):
        left = isometric_forces[i] if length_dependent and lengths[i] > 1.0 else 1.0
        heat = _maintenance_w_per_kg(max(activations[i], minimum), left, scaling, fast)
        rates_w[i] = max(heat, MINIMUM_HEAT_W_PER_KG) * masses_kg[i]
    return rates_w


# Not a gufunc: Numba caches those in two parts, and two processes that compile at once may leave
# parts that do not belong together, which crash whoever loads them.
@njit(
    void(float64[:, ::1], float64, float64, float64, bool_, float64[:, ::1]),
    cache=True,
    error_model="numpy",
)
def _fill_terms_w(  # type: ignore[no-untyped-def]  # noqa: PLR0917 (all fields of Energetics)
    state, scaling, fast, minimum, length_dependent, terms_w
):
    """Fill terms_w (4, n), in the order of MetabolicTerms, from metabolic_terms' inputs (9, n)."""
    for i in range(state.shape[1]):
        excitation, activation, length = state[0, i], state[1, i], state[2, i]
        velocity_per_s, isometric_force, contractile_force_n = state[3, i], state[4, i], state[5, i]
        optimal_length_m, max_velocity_per_s, mass_kg = state[6, i], state[7, i], state[8, i]
        charged = excitation if excitation > activation else 0.5 * (excitation + activation)
        charged = max(charged, minimum)
        left = isometric_force if length_dependent and length > 1.0 else 1.0
        maintenance = _maintenance_w_per_kg(charged, left, scaling, fast)
        sliding = left * _sliding_w_per_kg(
            charged, velocity_per_s, max_velocity_per_s, scaling, fast
        )
        terms_w[0, i] = maintenance * mass_kg
        terms_w[1, i] = sliding * mass_kg
        terms_w[2, i] = max(MINIMUM_HEAT_W_PER_KG - maintenance - sliding, 0.0) * mass_kg
        terms_w[3, i] = -contractile_force_n * velocity_per_s * optimal_length_m
