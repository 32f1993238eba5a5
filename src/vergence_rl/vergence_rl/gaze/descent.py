"""The inner loops of gaze control, compiled: each command of vergence runs through them.

Dimensions: n (muscles), n_angles, n_turns, n_places (see `eye_turns`).
"""

import numpy as np
from numba import boolean, float64, njit
from numba.types import UniTuple
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Free = NDArray[np.bool_]

# Units of activations and of their changes: both are of the order of 1 in these.
ACTIVATION, CHANGE = 0.1, 0.01
HALF = 0.5 * CHANGE / ACTIVATION
_N_STEPS, _CLOSE_DEG = 8, 1e-4
# Of the mean square of the slopes: below it, the free muscles cannot turn the eye that way.
_RIDGE_SHARE = 1e-10
# Of an angle's slopes, below which it depends on the others; and of the penalty's slopes, below
# which there is no way down.
_LEAST_SLOPE, _LEVEL = 1e-6, 1e-9
_ROUNDING = 1e-12


@njit(float64[::1](float64[::1], float64[::1]), cache=True, nogil=True)
def places_half_way(a: Floats, half: Floats) -> Floats:
    """Return 1, the entries of a + half and their products, (n_places,), half of the change (n,).

    Products are in the order of the upper triangle, row by row.
    """
    n = len(a)
    middle = a + half
    places = np.ones(1 + n + n * (n + 1) // 2)
    places[1 : n + 1] = middle
    k = n + 1
    for i in range(n):
        for j in range(i, n):
            places[k] = middle[i] * middle[j]
            k += 1
    return places


@njit(float64[:, ::1](float64[:, :, ::1], float64[::1], float64[::1]), cache=True, nogil=True)
def slopes_half_way(weights: Floats, a: Floats, half: Floats) -> Floats:
    """Return slopes (n_turns, n) of a change from a: weights (n_turns, n, n_places) of places."""
    n_turns, n, n_places = weights.shape
    places = places_half_way(a, half)
    slopes = np.zeros((n_turns, n))
    for t in range(n_turns):
        for i in range(n):
            for k in range(n_places):
                slopes[t, i] += weights[t, i, k] * places[k]
    return slopes


@njit(
    float64[::1](float64[::1], float64[:, ::1], float64[::1], UniTuple(float64[::1], 2)),
    cache=True,
    nogil=True,
)
def _stepped(d: Floats, slopes: Floats, left_deg: Floats, limits: tuple[Floats, Floats]) -> Floats:
    """Return d plus the least step for what is left; muscles at a limit leave it to the others."""
    n_turns, n = slopes.shape
    least, most = limits
    d, left_deg = d.copy(), left_deg.copy()
    free = np.ones(n, np.bool_)
    while free.any():
        of_free = slopes * free
        squares = of_free @ of_free.T
        squares += (_RIDGE_SHARE * np.trace(squares) / n_turns + 1e-300) * np.eye(n_turns)
        step = of_free.T @ np.linalg.solve(squares, left_deg)
        any_held = False
        for i in range(n):
            wanted = d[i] + step[i]
            stepped = min(max(wanted, least[i]), most[i])
            if free[i] and stepped != wanted:
                free[i], any_held = False, True
            left_deg -= slopes[:, i] * (stepped - d[i])
            d[i] = stepped
        if not any_held:
            break
    return d


@njit(
    float64[::1](
        float64[:, :, ::1],
        float64[::1],
        float64[::1],
        float64[::1],
        UniTuple(float64[::1], 2),
    ),
    cache=True,
    nogil=True,
)
def change_for(
    weights: Floats,
    a: Floats,
    d: Floats,
    wanted_deg: Floats,
    limits: tuple[Floats, Floats],
) -> Floats:
    """Return the change (n,) that turns the eye as wanted, (n_turns,), from d and nearest to it.

    weights: (n_turns, n, n_places) of the slopes.
    a: (n,) place.
    d: (n,) change to begin with.
    wanted_deg: (n_turns,).
    limits: (n,) least and most of the change; all in the units above.

    Newton's method, each step the least one of the muscles that are not at a limit.
    """
    for _ in range(_N_STEPS):
        slopes = slopes_half_way(weights, a, HALF * d)
        left_deg = wanted_deg - slopes @ d
        if np.abs(left_deg).max() < _CLOSE_DEG:
            break
        d = _stepped(d, slopes, left_deg, limits)
    return d


@njit(float64[::1](float64[::1], float64[:, ::1], boolean[::1]), cache=True, nogil=True)
def _down(slopes: Floats, held: Floats, free: Free) -> Floats:
    """Return the steepest descent (n,) of the free muscles that leaves the held angles.

    What the slopes have of each angle is taken out, angle by angle (Gram-Schmidt, twice: rounding).
    """
    n_angles = len(held)
    axes = held * free
    down = -slopes * free
    is_axis = np.zeros(n_angles, np.bool_)
    for j in range(n_angles):
        length = np.sqrt(axes[j] @ axes[j])
        for _ in range(2):
            for k in range(j):
                if is_axis[k]:
                    axes[j] -= (axes[k] @ axes[j]) * axes[k]
        left = np.sqrt(axes[j] @ axes[j])
        if left > _LEAST_SLOPE * length:
            is_axis[j] = True
            axes[j] /= left
    for _ in range(2):
        for j in range(n_angles):
            if is_axis[j]:
                down -= (axes[j] @ down) * axes[j]
    return down


@njit(
    float64[::1](float64[::1], float64[::1], float64[:, ::1], UniTuple(float64[::1], 2), float64),
    cache=True,
    nogil=True,
)
def lowered(
    activations: Floats,
    slopes: Floats,
    held: Floats,
    limits: tuple[Floats, Floats],
    largest: float,
) -> Floats:
    """Return the change (n,) of activations (n,) that descends a slope while angles are held.

    slopes: (n,) of the penalty.
    held: (n_angles, n) slopes of the angles.
    limits: lowest and highest activations (n,).
    largest: change of any activation.

    Straight down as far as the angles let it, until a muscle comes to a limit; then the others go
    on (gradient projection: Rosen 1960), until one has changed by the largest.
    """
    lowest, highest = limits
    n = len(activations)
    change = np.zeros(n)
    free = np.ones(n, np.bool_)
    level = _LEVEL * np.abs(slopes).max()
    while free.any():
        direction = _down(slopes, held, free)
        if np.abs(direction).max() <= level:
            break
        first, reach = -1, np.inf
        for i in range(n):
            if direction[i] == 0.0:
                continue
            if direction[i] < 0.0:
                end = max(lowest[i] - activations[i], -largest)
            else:
                end = min(highest[i] - activations[i], largest)
            far = max((end - change[i]) / direction[i], 0.0)
            if far < reach:
                first, reach = i, far
        change += reach * direction
        if abs(change[first]) >= (1.0 - _ROUNDING) * largest:
            break
        free[first] = False
    return change
