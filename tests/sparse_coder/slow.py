"""Slow, obvious versions of the coder's inner loops, in float64, to hold the fast ones against."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def slow_reduction(window: NDArray) -> Floats:
    """Return a window blurred by (1 4 6 4 1) / 16 along both axes, every other pixel of it.

    Mirrored at the border, whose pixel is not repeated.
    """
    weights = np.outer([1, 4, 6, 4, 1], [1, 4, 6, 4, 1]) / 256.0
    around = np.pad(window.astype(np.float64), 2, mode="reflect")
    places = range(0, len(window), 2)
    return np.array(
        [[(weights * around[y : y + 5, x : x + 5]).sum() for x in places] for y in places]
    )


def slow_patches(left: NDArray, right: NDArray) -> Floats:
    """Return all patches of two square windows, each eye's part with mean 0 and norm 1."""
    patches = []
    for top in range(0, len(left) - 7, 4):
        for first in range(0, len(left) - 7, 4):
            halves = [
                window[top : top + 8, first : first + 8].astype(np.float64).ravel()
                for window in (left, right)
            ]
            halves = [half - half.mean() for half in halves]
            patches.append(np.concatenate([half / np.linalg.norm(half) for half in halves]))
    return np.array(patches)


def slow_pursuit(
    patches: NDArray, atoms: NDArray, n_selections: int
) -> tuple[list[list[int]], Floats]:
    """Matching pursuit, one residual at a time, without a Gram matrix.

    Returns the selected atoms of each patch and the residuals (n_patches, n_pixels).
    """
    selected, residuals = [], []
    for patch in patches.astype(np.float64):
        residual, chosen = patch.copy(), []
        for _ in range(n_selections):
            correlations = [float(atom.astype(np.float64) @ residual) for atom in atoms]
            k = int(np.argmax(np.abs(correlations)))
            residual = residual - correlations[k] * atoms[k].astype(np.float64)
            chosen.append(k)
        selected.append(chosen)
        residuals.append(residual)
    return selected, np.array(residuals)
