"""What the eyes are rewarded for (K17 II): pictures that the code explains, for little energy.

    E = sum over all scales of
        (sum_j |p_j - sum_k kappa_jk phi_k|^2) / (sum_j |p_j|^2)        (eq. 2)
    r = -E - lambda C                                                   (eq. 5)

p_j: binocular patch j; phi_k: basis functions; kappa_jk: their coefficients; C: settled metabolic
rate of the commanded muscles, W; lambda: what a watt costs, 1/W, 0 in model M.

Blurred pictures are explained best, so -E leaves a lens out of focus. For eyes with lenses the
information of the code takes its place:

    I = sum over all scales of the mean over patches of 0.5 log((n + S_j) / (n + R_j))
    r = I - lambda C

S_j: energy of patch j, before its halves have norm 1; R_j: what the code leaves of it; n: energy of
the sensor's noise in a patch. (ours: the information in nats that a code with Gaussian errors has
of a Gaussian signal with such noise, Cover & Thomas 2006, section 9.1, were a patch one number.)
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lockstep import InputError, generator
from sparse_coder.matching_pursuit import Selections, energy


def reconstruction_error(patches: NDArray[np.float32], selections: Selections) -> float:
    """Return the share of the patches' energy that the code of one scale leaves, in [0, 1].

    K17 eq. 2, as a fraction (D3), since the paper's lambda needs it. Each selection of a unit atom
    takes kappa^2 from the residual's energy (Mallat & Zhang 1993), so the residuals need not be
    formed. Patches without any energy leave nothing to explain: their error is 0.

    patches: (n_patches, n_pixels); selections: of these patches.
    """
    total = energy(patches)
    if total == 0.0:
        return 0.0
    return max(0.0, 1.0 - energy(selections.coefficients) / total)


def information(
    energies: NDArray[np.float64], residuals: NDArray[np.float64], noise_energy: float
) -> float:
    """Return I of one scale, 0 or more: the mean over patches of 0.5 log((n + S) / (n + R)).

    energies: (n_patches, 2) of each eye's half, S is their sum; residuals: (n_patches, 2) the share
    of each half's energy that its code leaves; noise_energy: n, above 0.
    """
    whole = noise_energy + energies.sum(axis=1)
    left = noise_energy + (residuals * energies).sum(axis=1)
    return float(np.mean(0.5 * np.log(whole / left)))


def noise_energy(noise_sd: float, gain: float, n_pixels: int) -> float:
    """Return n, the energy of white noise in a patch: n_pixels (sigma g)^2.

    noise_sd: sigma of a pixel, in grey levels; gain: g, what whitening makes of it, 1 without.
    """
    return n_pixels * (noise_sd * gain) ** 2


def lambda_by_now(highest: float, learning_steps: int, n_rising: float) -> float:
    """Return lambda, in 1/W, by now: it rises linearly from 0 to its highest value (D21).

    Eyes learn what to look at before saving is worth much. learning_steps: done so far; n_rising:
    steps until it has risen, 0 where it is constant (K17).
    """
    return highest * learning_steps / n_rising if learning_steps < n_rising else highest


@dataclass(frozen=True)
class Reward:
    """r of an observation, and how much of it energy takes.

    energy_penalty: lambda C, to the last bit as r contains it: r + energy_penalty is -E or I,
    unless the penalty exceeds it.
    """

    value: float
    energy_penalty: float


def reward(worth: float, rate_w: float, weight: float) -> Reward:
    """Return r = -E - lambda C (K17 eq. 5), or I - lambda C.

    worth: -E or I; rate_w: C; weight: lambda, 1/W. Raises InputError for a rate that is not finite
    or is negative.
    """
    if not (math.isfinite(rate_w) and rate_w >= 0.0):
        raise InputError(f"metabolic rate: expected 0 W or more, got {rate_w}")
    value = worth - weight * rate_w
    return Reward(value, worth - value)


def random_reward(seed: int, learning_steps: int, iteration: int) -> Reward:
    """Return a number, uniform in [-1, 0], that knows nothing of the eyes, and takes no energy.

    A function of the seed and the time: learning_steps of the coder, iteration in the episode.
    """
    draw = generator(seed, f"reward {iteration}", learning_steps)
    return Reward(-float(draw.random()), 0.0)
