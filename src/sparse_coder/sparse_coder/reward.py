"""The reward that teaches the eyes."""

import math

import numpy as np
from numpy.typing import NDArray

from lockstep.errors import InputError


def reward(
    reconstruction_error: NDArray[np.float64], metabolic_rate_w: float, metabolic_cost_weight: float
) -> float:
    """Return r = -E - lambda C (K17 eq. 5), where E is the sum of both scales' errors.

    reconstruction_error: (n_scales,); metabolic_rate_w: C, the settled rate of the
    muscles that are charged, at the current activations; metabolic_cost_weight: lambda in 1/W.
    Raises InputError for a rate that is not finite or is negative.
    """
    if not (math.isfinite(metabolic_rate_w) and metabolic_rate_w >= 0.0):
        raise InputError(f"metabolic rate: expected 0 W or more, got {metabolic_rate_w}")
    return float(-np.sum(reconstruction_error) - metabolic_cost_weight * metabolic_rate_w)
