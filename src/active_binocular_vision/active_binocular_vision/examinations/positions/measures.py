"""What looks at nine positions and random places show of Sherrington's, Listing's, Hering's law."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.examinations.positions.examination import Examined
from active_binocular_vision.examinations.positions.listing import (
    DisplacementPlane,
    displacement_plane,
    tilt_per_vergence,
)
from active_binocular_vision.examinations.positions.posture import Posture
from experiment_manager.measures.criteria import criteria_of
from experiment_manager.measures.metrics import antagonist_names, silent_below
from experiment_manager.measures.yoked import SharedChange, shared_change, yoked_names
from eye_plant import EyePlantConfig
from lockstep import ALL_MUSCLES, COMMAND_SPACES, MUSCLE_NAMES, SIDES

Array = NDArray[np.float64]

# A plane through three points has no thickness.
_FEWEST_GAZES = 4


@dataclass(frozen=True)
class Silence:
    """Sherrington's law: of two antagonists, or of all pairs together.

    share_silent, share_silent_in_optimum: of the gazes at which one of both is silent;
    share_optimally_silent: of the muscles that are silent with the least energy, how many are
    silent in these eyes, over all gazes; None where none is; n_silent_in_optimum: muscles that are,
    over all gazes.
    """

    share_silent: float
    share_silent_in_optimum: float
    share_optimally_silent: float | None
    n_silent_in_optimum: int


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


def silences(silent: NDArray[np.bool_], optimum: NDArray[np.bool_]) -> dict[str, Silence]:
    """Return the measures of each two antagonists, and of "all".

    silent: (n, n_pictures, 12) of the eyes at n gazes; optimum: (n, 12) of the least energy.
    """
    pairs = antagonist_names(COMMAND_SPACES[ALL_MUSCLES])
    indices = np.array([[MUSCLE_NAMES.index(name) for name in names] for names in pairs])
    chosen = {"-".join(names): i[None] for names, i in zip(pairs, indices, strict=True)}
    return {
        name: _silence(silent[..., i], optimum[..., i])
        for name, i in (chosen | {"all": indices}).items()
    }


def _silence(silent: NDArray[np.bool_], optimum: NDArray[np.bool_]) -> Silence:
    """Return the measures of k pairs; silent: (n, n_pictures, k, 2), optimum: (n, k, 2)."""
    both = np.broadcast_to(optimum[:, None], silent.shape)
    n_cases = int(optimum.sum())
    return Silence(
        share_silent=float(silent.any(axis=-1).mean()),
        share_silent_in_optimum=float(optimum.any(axis=-1).mean()),
        share_optimally_silent=float(silent[both].mean()) if n_cases else None,
        n_silent_in_optimum=n_cases,
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
    eyes = examined.nine.eyes, examined.random.eyes
    return _planes(
        examined.nine.distances_m,
        [np.median(posture.rotation_vectors, axis=2) for posture in eyes],
        [np.median(posture.vergence_deg, axis=2) for posture in eyes],
    )


def planes_of_optimum(examined: Examined) -> dict[str, Planes]:
    """Return the planes of both eyes with the least energy, at the same places."""
    optimum = examined.nine.optimum, examined.random.optimum
    return _planes(
        examined.nine.distances_m,
        [posture.rotation_vectors for posture in optimum],
        [posture.vergence_deg for posture in optimum],
    )


def _planes(
    distances_m: Sequence[float], parts: Sequence[Array], vergences_of_parts_deg: Sequence[Array]
) -> dict[str, Planes]:
    """Return planes; parts: rotation vectors (n_distances, n, 2, 3) of some of the places."""
    vectors = np.concatenate(parts, axis=1)
    vergence_deg = np.concatenate(vergences_of_parts_deg, axis=1)
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
