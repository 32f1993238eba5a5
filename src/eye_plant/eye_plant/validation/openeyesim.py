"""What is published of OpenEyeSim's static behaviour, to hold the k17 eyes against.

The two maps themselves (adduction and metabolic cost of one eye against medial and lateral
activation, 11 x 11) are not ours to ship; a file with the columns medial, lateral, adduction in
deg, cost in W can be named in the environment variable ABV_OPENEYESIM_MAPS.
"""

import csv
import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from lockstep.errors import InputError

Array = NDArray[np.float64]

MAPS_VARIABLE = "ABV_OPENEYESIM_MAPS"
N_GRID = 11

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
        return spline_weights(medial) @ self.adduction_deg @ spline_weights(lateral).T


def load_maps() -> Maps | None:
    """Read the maps that the environment names, None when it names none."""
    path = os.environ.get(MAPS_VARIABLE, "")
    if not path:
        return None
    if not Path(path).is_file():
        raise InputError(f"{MAPS_VARIABLE} must name a file, got {path!r}")
    with open(path, newline="") as file:
        rows = np.array([[float(entry) for entry in row] for row in list(csv.reader(file))[1:]])
    if rows.shape != (N_GRID**2, 4):
        raise InputError(f"{path}: expected 121 rows of 4 numbers, got shape {rows.shape}")
    return Maps(rows[:, 2].reshape(N_GRID, N_GRID), rows[:, 3].reshape(N_GRID, N_GRID))


def spline_weights(activations: Array) -> Array:
    """Weights (n, 11) of the grid's values in a not-a-knot cubic spline at activations (n,).

    With h the spacing and s the second derivatives at the knots, s_(i-1) + 4 s_i + s_(i+1) =
    6 (y_(i-1) - 2 y_i + y_(i+1)) / h^2, and the third derivative does not jump at the second and
    the last but one knot.
    """
    spacing = 1.0 / (N_GRID - 1)
    left, right = np.zeros((N_GRID, N_GRID)), np.zeros((N_GRID, N_GRID))
    for i in range(1, N_GRID - 1):
        left[i, i - 1 : i + 2] = (1.0, 4.0, 1.0)
        right[i, i - 1 : i + 2] = np.array((6.0, -12.0, 6.0)) / spacing**2
    left[0, :3] = left[-1, -3:] = (1.0, -2.0, 1.0)
    curvature = np.linalg.solve(left, right)
    cell = np.clip(np.asarray(activations) / spacing, 0.0, N_GRID - 1.0)
    index = np.minimum(cell.astype(int), N_GRID - 2)
    b = (cell - index)[:, np.newaxis]
    a = 1.0 - b
    values = np.eye(N_GRID)
    bend = (a**3 - a) * curvature[index] + (b**3 - b) * curvature[index + 1]
    return a * values[index] + b * values[index + 1] + bend * spacing**2 / 6.0
