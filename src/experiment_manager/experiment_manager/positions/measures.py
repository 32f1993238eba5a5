"""What looks at nine positions and random places show of Sherrington's, Listing's, Hering's law."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from experiment_manager.measures.criteria import criteria_of
from experiment_manager.measures.metrics import silent_below
from experiment_manager.measures.yoked import SharedChange, shared_change, yoked_names
from experiment_manager.positions.antagonists import Silence, silences
from experiment_manager.positions.examination import Examined
from experiment_manager.positions.listing import (
    DisplacementPlane,
    displacement_plane,
    tilt_per_vergence,
)
from experiment_manager.positions.posture import Posture
from eye_plant.config import EyePlantConfig
from lockstep.command_space import ALL_MUSCLES, COMMAND_SPACES, MUSCLE_NAMES, SIDES

Array = NDArray[np.float64]

# A plane through three points has no thickness.
_FEWEST_GAZES = 4


def is_silent(activations: Array, plant: EyePlantConfig) -> NDArray[np.bool_]:
    """Return whether muscles are silent, as results.json counts it; activations: (..., 12)."""
    criteria = criteria_of(plant)
    silent: NDArray[np.bool_] = activations - criteria.lowest_activations < silent_below(criteria)
    return silent


def silences_of(examined: Examined) -> dict[str, Silence]:
    """Return the measures of antagonists at the nine positions that the least energy reaches."""
    nine, plant = examined.nine, examined.learners.plant
    optimum = nine.optimum.activations
    reached = np.isfinite(optimum).all(axis=-1)
    if not reached.any():
        return {}
    return silences(
        is_silent(nine.eyes.activations[reached], plant), is_silent(optimum[reached], plant)
    )


@dataclass(frozen=True)
class Planes:
    """Displacement planes of one eye: by distance in m, None where too few gazes are reached.

    tilt_per_vergence: in deg per deg, None with less than two planes.
    """

    by_distance: dict[float, DisplacementPlane | None]
    tilt_per_vergence: float | None

    def to_json(self) -> dict[str, Any]:
        """Return what a document has."""
        by_distance = {
            f"{distance_m:g}": vars(plane) if plane else None
            for distance_m, plane in self.by_distance.items()
        }
        return {"by_distance": by_distance, "tilt_per_vergence": self.tilt_per_vergence}


def planes_of_eyes(examined: Examined) -> dict[str, Planes]:
    """Return the planes of both eyes, of medians over pictures at nine positions and all others."""
    return _planes(
        examined.nine.distances_m,
        [
            (np.median(p.rotation_vectors, axis=2), np.median(p.vergence_deg, axis=2))
            for p in (examined.nine.eyes, examined.random.eyes)
        ],
    )


def planes_of_optimum(examined: Examined) -> dict[str, Planes]:
    """Return the planes of both eyes with the least energy, at the same places."""
    return _planes(
        examined.nine.distances_m,
        [
            (p.rotation_vectors, p.vergence_deg)
            for p in (examined.nine.optimum, examined.random.optimum)
        ],
    )


def _planes(
    distances_m: Sequence[float], places: Sequence[tuple[Array, Array]]
) -> dict[str, Planes]:
    """Return planes; places: rotation vectors (n_distances, n, 2, 3) and vergence in deg."""
    vectors, vergence_deg = (np.concatenate(p, axis=1) for p in zip(*places, strict=True))
    reached = np.isfinite(vergence_deg)
    found = {}
    for i_side, side in enumerate(SIDES):
        planes = [
            displacement_plane(of_distance[known, i_side]) if known.sum() >= _FEWEST_GAZES else None
            for of_distance, known in zip(vectors, reached, strict=True)
        ]
        tilts_deg, vergences_deg = (
            np.array(values)
            for values in (
                [plane.temporal_tilt_deg for plane in planes if plane],
                [np.nanmedian(v) for v, plane in zip(vergence_deg, planes, strict=True) if plane],
            )
        )
        found[side] = Planes(
            dict(zip(distances_m, planes, strict=True)),
            tilt_per_vergence(tilts_deg, vergences_deg) if len(tilts_deg) > 1 else None,
        )
    return found


def yoked_changes(posture: Posture, distances_m: Sequence[float]) -> dict[str, SharedChange]:
    """Return how yoked muscles change together; posture: (n_distances, n) or more dimensions."""
    values = posture.activations.reshape(len(distances_m), -1, len(MUSCLE_NAMES))
    distance_m = np.repeat(distances_m, values.shape[1])
    flat = values.reshape(-1, len(MUSCLE_NAMES))
    known = np.isfinite(flat).all(axis=1)
    return {
        "-".join(names): shared_change(
            flat[known][:, [MUSCLE_NAMES.index(name) for name in names]].T, distance_m[known]
        )
        for names in yoked_names(COMMAND_SPACES[ALL_MUSCLES])
    }
