"""What is published of OpenEyeSim's static behaviour, to hold the k17 eyes against.

The two maps themselves (adduction and metabolic cost of one eye against medial and lateral
activation, 11 x 11) are not ours to ship; a file with the columns medial, lateral, adduction in
deg, cost in W can be named in the environment variable ABV_OPENEYESIM_MAPS.
"""

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from lockstep.errors import InputError

Array = NDArray[np.float64]

MAPS_VARIABLE = "ABV_OPENEYESIM_MAPS"
N_GRID = 11
_GRID = np.linspace(0.0, 1.0, N_GRID)

# Object distance in m, and the one activation (medial, lateral) that verges on it.
SINGLE_MUSCLE_POINTS: tuple[tuple[float, float, float], ...] = (
    (0.5, 0.0736, 0.0),
    (1.0, 0.0315, 0.0),
    (2.0, 0.0089, 0.0),
    (4.0, 0.0, 0.0027),
    (6.0, 0.0, 0.0064),
)


def power_law_w(medial: float, lateral: float) -> float:
    """Cost of one eye: a power law that meets OpenEyeSim's map to 6 mW rms at its grid points."""
    return 2.229 * max(medial, 0.005) ** 0.6 + 2.030 * max(lateral, 0.005) ** 0.6


@dataclass(frozen=True)
class Maps:
    """Both maps on the grid 0, 0.1, ..., 1: rows medial, columns lateral activation."""

    adduction_deg: Array
    cost_w: Array

    def spline_adduction_deg(self, medial: Array, lateral: Array) -> Array:
        """Cubic spline of the adduction, on every pair of medial (n,) and lateral (m,): (n, m)."""
        by_lateral = CubicSpline(_GRID, self.adduction_deg, axis=1)(lateral)
        adduction_deg: Array = CubicSpline(_GRID, by_lateral, axis=0)(medial)
        return adduction_deg


def load_maps() -> Maps | None:
    """Read the maps that the environment names, None when it names none.

    Raises InputError for a file that does not hold 121 rows of four numbers below its header, one
    for each pair of activations of the grid, in any order.
    """
    path = os.environ.get(MAPS_VARIABLE, "")
    if not path:
        return None
    if not Path(path).is_file():
        raise InputError(f"{MAPS_VARIABLE}: expected the name of a file, got {path!r}")
    try:
        rows = np.loadtxt(path, delimiter=",", skiprows=1, ndmin=2)
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: expected {N_GRID**2} rows of 4 numbers: {error}") from error
    if rows.shape != (N_GRID**2, 4):
        raise InputError(f"{path}: expected 121 rows of 4 numbers, got shape {rows.shape}")
    rows = rows[np.lexsort((rows[:, 1], rows[:, 0]))]
    medial, lateral, adduction_deg, cost_w = rows.T.reshape(4, N_GRID, N_GRID)
    if not (np.allclose(medial, _GRID[:, None]) and np.allclose(lateral, _GRID)):
        raise InputError(
            f"{path}: expected each pair of medial and lateral activations 0, 0.1, ..., 1 once, in "
            "the first two columns, got others"
        )
    return Maps(adduction_deg, cost_w)
