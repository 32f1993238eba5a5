"""Commands at the limits of activation, for two muscles whose changes are worth more together.

Where one muscle cannot go on, the other makes up for it, in the direction of the covariance of what
is left to learn (D16): widest where the reward hardly changes, which is where both muscles contract
together and the gaze stays. So a gaze can be asked for with activations below zero, and the nearest
pair that there is has one silent muscle.
"""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def within_limits(wanted: Floats, covariance: Floats, lowest: Floats, highest: Floats) -> Floats:
    """Return the allowed activations c of least (c - a)^T covariance^-1 (c - a), a those wanted.

    All (2,), the covariance (2, 2). The least lies on the limit of a muscle that is beyond its own.
    """
    clipped: Floats = np.clip(wanted, lowest, highest)
    beyond = [k for k in (0, 1) if clipped[k] != wanted[k]]
    if not beyond:
        return clipped
    (a, b), (_, d) = covariance.tolist()
    adjoint = np.array([[d, -b], [-b, a]])  # the inverse but for a positive factor
    found = [
        np.clip(wanted + (clipped[k] - wanted[k]) * _made_up(covariance, k), lowest, highest)
        for k in beyond
    ]
    return min(found, key=lambda c: float((c - wanted) @ adjoint @ (c - wanted)))


def freed_targets(
    best: Floats, wanted: Floats, covariance: Floats, lowest: Floats, highest: Floats
) -> Floats:
    """Return where each visit should have wanted to go, (n_visits, 2), the best place being known.

    best: (2,); wanted: (n_visits, 2) where the actor wanted to go. A best place at a limit, with
    the actor beyond that limit, says no more than that: the actor may stay there, and only its
    other muscle moves, as `within_limits` would have it (censored regression: Tobin 1958).
    """
    held = ((best <= lowest) & (wanted < lowest)) | ((best >= highest) & (wanted > highest))
    targets: Floats = np.where(held, wanted, best)
    for k in (0, 1):
        alone = held[:, k] & ~held[:, 1 - k]
        excess = wanted[alone, k] - best[k]
        targets[alone] = best + excess[:, None] * _made_up(covariance, k)
    return targets


def _made_up(covariance: Floats, k: int) -> Floats:
    """Return the change of both muscles, (2,), that goes with a change by 1 of muscle k."""
    if not covariance[k, k] > 0.0:
        return np.eye(2)[k]
    direction: Floats = covariance[:, k] / covariance[k, k]
    return direction
