"""What postures at nine positions show: energy, silence, displacement planes, yoked muscles."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from msgspec.structs import astuple
from numpy.typing import NDArray

from active_binocular_vision.examinations.nine_positions.listing import (
    DisplacementPlane,
    displacement_plane,
    tilt_per_vergence,
)
from active_binocular_vision.examinations.nine_positions.looking import Gazes, NinePositionsTraces
from active_binocular_vision.examinations.nine_positions.posture import ERROR_AXES, Posture
from active_binocular_vision.examinations.nine_positions.rows import (
    LEARNED,
    LEAST,
    AntagonistRow,
    DistanceRow,
    LookRow,
    PlaneRow,
    PositionRow,
    TiltRow,
    YokedRow,
)
from experiment_manager.measures.antagonists import (
    active_pairs,
    antagonist_names,
    reciprocity,
    silent_below,
)
from experiment_manager.measures.criteria import criteria_of
from experiment_manager.measures.yoked import SharedChange, shared_change, yoked_names
from eye_plant import EyePlantConfig
from lockstep import ALL_MUSCLES, COMMAND_SPACES, MUSCLE_NAMES, SIDES

Array = NDArray[np.float64]

# A plane through three points has no thickness.
_FEWEST_GAZES = 4


def looks(places: str, gazes: Gazes) -> Iterator[LookRow]:
    """Yield a row for each look and each optimum; places: nine or random."""
    for i, i_target in np.ndindex(len(gazes.distances_m), len(gazes.targets_deg)):
        pictures = gazes.pictures[i_target].tolist()
        shown = [(LEARNED, picture, (i, i_target, k)) for k, picture in enumerate(pictures)]
        for eyes, picture, at in [*shown, (LEAST, None, (i, i_target))]:
            posture = gazes.eyes if eyes == LEARNED else gazes.optimum
            azimuth_deg, elevation_deg = gazes.targets_deg[i_target].tolist()
            yield LookRow(
                places=places,
                eyes=eyes,
                object_distance_m=gazes.distances_m[i],
                target_azimuth_deg=azimuth_deg,
                target_elevation_deg=elevation_deg,
                stimulus=picture,
                wanted_gaze_deg=gazes.wanted_gaze_deg[i, i_target],
                gaze_deg=posture.gaze_deg[at],
                torsion_deg=posture.torsion_deg[at],
                errors_deg=posture.errors_deg[at],
                missed_deg=posture.missed_deg[at],
                metabolic_rate_w=posture.metabolic_rate_w[at],
                activations=posture.activations[at],
            )


def positions(nine: Gazes) -> Iterator[PositionRow]:
    """Yield the medians over pictures of each distance and position."""
    rates_w = np.median(nine.eyes.metabolic_rate_w, axis=2)
    least_w = nine.optimum.metabolic_rate_w
    for at in np.ndindex(rates_w.shape):
        azimuth_deg, elevation_deg = nine.targets_deg[at[1]].tolist()
        yield PositionRow(
            object_distance_m=nine.distances_m[at[0]],
            target_azimuth_deg=azimuth_deg,
            target_elevation_deg=elevation_deg,
            missed_deg=float(np.median(nine.eyes.missed_deg[at])),
            gaze_deg=np.median(nine.eyes.gaze_deg[at], axis=0),
            errors_deg=np.median(nine.eyes.errors_deg[at], axis=0),
            metabolic_rate_w=float(rates_w[at]),
            least_metabolic_rate_w=float(least_w[at]),
            cost_ratio=float(rates_w[at] / least_w[at]),
        )


def distances(nine: Gazes) -> Iterator[DistanceRow]:
    """Yield the medians of each distance, and of all together as the last row."""
    for i, distance_m in enumerate(nine.distances_m):
        yield DistanceRow(object_distance_m=distance_m, **medians(nine, [i]))
    yield DistanceRow(object_distance_m=None, **medians(nine, [*range(len(nine.distances_m))]))


def medians(nine: Gazes, i_distances: Sequence[int]) -> dict[str, Any]:
    """Return the fields of Medians over some of the distances."""
    eyes, least_w = nine.eyes, nine.optimum.metabolic_rate_w[i_distances]
    reached = np.isfinite(least_w)
    rates_w = eyes.metabolic_rate_w[i_distances]
    ratios = (np.median(rates_w, axis=2) / least_w)[reached]
    errors_deg = np.abs(eyes.errors_deg[i_distances]).reshape(-1, len(ERROR_AXES))
    return {
        "missed_deg": float(np.median(eyes.missed_deg[i_distances])),
        "errors_deg": np.median(errors_deg, axis=0),
        "metabolic_rate_w": float(np.median(rates_w)),
        "least_metabolic_rate_w": float(np.median(least_w[reached])) if reached.any() else np.nan,
        "cost_ratio": float(np.median(ratios)) if reached.any() else np.nan,
    }


def is_silent(activations: Array, plant: EyePlantConfig) -> NDArray[np.bool_]:
    """Return whether muscles are silent, as results.json counts it; activations: (..., 12)."""
    criteria = criteria_of(plant)
    silent: NDArray[np.bool_] = activations - criteria.lowest_activations < silent_below(criteria)
    return silent


def active_muscles(nine: Gazes, plant: EyePlantConfig) -> float:
    """Return the median number of active muscles over all looks."""
    return float(np.median((~is_silent(nine.eyes.activations, plant)).sum(axis=-1)))


def antagonist_rows(traces: NinePositionsTraces) -> list[AntagonistRow]:
    """Return the measures of each two antagonists and of "all" as the last.

    At those of the nine positions that the least energy reaches; none where it reaches no one.
    """
    criteria = criteria_of(traces.plant)
    optimum = traces.nine.optimum.activations
    reached = np.isfinite(optimum).all(axis=-1)
    if not reached.any():
        return []
    both = (traces.nine.eyes.activations[reached], optimum[reached])
    of_eyes, of_optimum = (values - criteria.lowest_activations for values in both)
    return rows_of_antagonists(of_eyes, of_optimum, silent_below(criteria))


def rows_of_antagonists(of_eyes: Array, of_optimum: Array, silent: float) -> list[AntagonistRow]:
    """Return the measures of each two antagonists and of "all".

    of_eyes: activations (n, n_pictures, 12) at n gazes; of_optimum: (n, 12) with the least energy;
    both above their least; silent: below that a muscle is.
    """
    pairs = antagonist_names(COMMAND_SPACES[ALL_MUSCLES])
    indices = np.array([[MUSCLE_NAMES.index(name) for name in names] for names in pairs])
    chosen = {"-".join(names): i[None] for names, i in zip(pairs, indices, strict=True)}
    return [
        _antagonists(name, of_eyes[..., i], of_optimum[..., i], silent)
        for name, i in (chosen | {"all": indices}).items()
    ]


def _antagonists(name: str, of_eyes: Array, of_optimum: Array, silent: float) -> AntagonistRow:
    """Return the measures of k pairs; of_eyes: (n, n_pictures, k, 2), of_optimum: (n, k, 2)."""
    is_silent_in_optimum = np.broadcast_to((of_optimum < silent)[:, None], of_eyes.shape)
    n_cases = int((of_optimum < silent).sum())
    cases = of_eyes.reshape(-1, *of_eyes.shape[2:]), of_optimum
    active, active_in_optimum = (active_pairs(values >= silent) for values in cases)
    assert active is not None
    assert active_in_optimum is not None
    return AntagonistRow(
        antagonists=name,
        active=astuple(active),
        active_in_optimum=astuple(active_in_optimum),
        slope=[reciprocity(values, silent).slope for values in cases],
        share_optimally_silent=(
            float((of_eyes < silent)[is_silent_in_optimum].mean()) if n_cases else None
        ),
        n_silent_in_optimum=n_cases,
    )


@dataclass(frozen=True)
class Planes:
    """Displacement planes of one eye: by distance in m, None where too few gazes are reached.

    tilt_per_vergence: in deg per deg, None with less than two planes.
    """

    by_distance: dict[float, DisplacementPlane | None]
    tilt_per_vergence: float | None


def planes_of_eyes(traces: NinePositionsTraces) -> dict[str, Planes]:
    """Return the planes of both eyes, of medians over pictures at nine positions and all others."""
    postures = traces.nine.eyes, traces.random.eyes
    return _planes(traces, postures, lambda values: np.median(values, axis=2))


def planes_of_optimum(traces: NinePositionsTraces) -> dict[str, Planes]:
    """Return the planes of both eyes with the least energy, at the same places."""
    return _planes(traces, (traces.nine.optimum, traces.random.optimum), lambda values: values)


def _planes(
    traces: NinePositionsTraces, postures: Iterable[Posture], of: Callable[[Array], Array]
) -> dict[str, Planes]:
    """Return planes of postures; of: makes (n_distances, n, ...) of their values."""
    vectors = np.concatenate([of(posture.rotation_vectors) for posture in postures], axis=1)
    vergence_deg = np.concatenate([of(posture.vergence_deg) for posture in postures], axis=1)
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
            dict(zip(traces.nine.distances_m, planes, strict=True)),
            tilt_per_vergence(tilts_deg, vergences_deg) if len(tilts_deg) > 1 else None,
        )
    return found


def plane_rows(eyes: str, planes: Mapping[str, Planes]) -> Iterator[PlaneRow]:
    """Yield the planes of both eyes by distance; eyes: learned or least."""
    names = "offset_deg", "temporal_tilt_deg", "upward_tilt_deg", "thickness_deg"
    for side, of_eye in planes.items():
        for distance_m, plane in of_eye.by_distance.items():
            measures = vars(plane) if plane else dict.fromkeys(names)
            yield PlaneRow(eyes=eyes, side=side, object_distance_m=distance_m, **measures)


def tilts(eyes: str, planes: Mapping[str, Planes]) -> TiltRow:
    """Return the tilts per deg of vergence of both eyes, and their mean."""
    left, right = (planes[side].tilt_per_vergence for side in SIDES)
    mean = None if left is None or right is None else (left + right) / 2.0
    return TiltRow(eyes=eyes, left=left, right=right, mean=mean)


def yoked(random: Gazes) -> list[YokedRow]:
    """Return how each two yoked muscles change together, learned and with the least energy."""
    both = [yoked_changes(p, random.distances_m) for p in (random.eyes, random.optimum)]
    return [
        YokedRow(
            muscles=pair,
            correlation=[of[pair].correlation for of in both],
            slope=[of[pair].slope for of in both],
        )
        for pair in both[0]
    ]


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
