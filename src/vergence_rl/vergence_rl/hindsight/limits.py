"""Commands at the limits of activation, for muscles whose changes are worth more together.

Where one muscle cannot go on, the others make up for it, in the direction of the covariance of what
is left to learn (D16): widest where the reward hardly changes, which is where muscles contract
together and the gaze stays. So a gaze can be asked for with activations below zero, and the nearest
activations that there are have silent muscles.
"""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Held = NDArray[np.bool_]


def within_limits(wanted: Floats, covariance: Floats, lowest: Floats, highest: Floats) -> Floats:
    """Return the allowed activations c of least (c - a)^T covariance^-1 (c - a), a those wanted.

    wanted: (n,) activations a.
    covariance: (n, n).
    lowest, highest: (n,).

    Found by an active set: muscles beyond a limit are held there, and the others make up for it.
    More are held until none is beyond, and those that would turn back are released (Nocedal &
    Wright 2006, ch. 16).
    """
    clipped: Floats = np.clip(wanted, lowest, highest)
    held: Held = clipped != wanted
    if not (held.any() and np.isfinite(covariance).all()):
        return clipped
    found = clipped
    for _ in range(2 * len(wanted)):
        found = made_up(wanted, clipped, covariance, held)
        beyond = ~held & ((found < lowest) | (found > highest))
        clipped = np.where(beyond, np.clip(found, lowest, highest), clipped)
        let_go = _turning_back(wanted, found, covariance, held, lowest) & (lowest < highest)
        if not (beyond.any() or let_go.any()):
            break
        held = (held | beyond) & ~let_go
    return np.clip(found, lowest, highest)


def freed_targets(
    best: Floats, wanted: Floats, covariance: Floats, lowest: Floats, highest: Floats
) -> Floats:
    """Return where each visit should have wanted to go, (n_visits, n), the best place being known.

    best: (n,) place.
    wanted: (n_visits, n) where the actor wanted to go.
    covariance: (n, n).
    lowest, highest: (n,).

    A best place at a limit, with the actor beyond that limit, says no more than that: the actor may
    stay there, and only its other muscles move, as `within_limits` would have it (censored
    regression: Tobin 1958).
    """
    held = ((best <= lowest) & (wanted < lowest)) | ((best >= highest) & (wanted > highest))
    targets: Floats = np.where(held, wanted, best)
    for i in np.flatnonzero(held.any(axis=1) & ~held.all(axis=1)):
        targets[i] = made_up(best, wanted[i], covariance, held[i])
    return targets


def made_up(free: Floats, at: Floats, covariance: Floats, held: Held) -> Floats:
    """Return activations (n,) whose held ones are those of `at`, the others following from `free`.

    The change of the others is what the covariance lets one expect of it.

    free: (n,) activations from which the others follow.
    at: (n,) activations of those that are held.
    covariance: (n, n).
    held: (n,) which ones are.
    """
    held_ones = np.flatnonzero(held)
    change = at[held_ones] - free[held_ones]
    if len(held_ones) == 1:
        (k,) = held_ones
        if not covariance[k, k] > 0.0:
            return np.where(held, at, free)
        return free + change[0] * (covariance[:, k] / covariance[k, k])
    across = covariance[np.ix_(held_ones, held_ones)]
    if not held.all():
        others = np.flatnonzero(~held)
        expected = covariance[np.ix_(others, held_ones)] @ np.linalg.lstsq(across, change)[0]
        found = np.where(held, at, free)
        found[others] += expected
        return found
    return at.copy()


def _turning_back(
    wanted: Floats, found: Floats, covariance: Floats, held: Held, lowest: Floats
) -> Held:
    """Return which held muscles (n,) would leave their limit again, were they let go."""
    held_ones = np.flatnonzero(held)
    turning = np.zeros_like(held)
    if len(held_ones) < 2:
        return turning
    across = covariance[np.ix_(held_ones, held_ones)]
    pull = np.linalg.lstsq(across, (found - wanted)[held_ones])[0]
    # At its lower limit a muscle is held up, at the other one down.
    is_low = found[held_ones] <= lowest[held_ones]
    turning[held_ones] = np.where(is_low, pull < 0.0, pull > 0.0)
    return turning
