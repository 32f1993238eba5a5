"""Frozen learners look at the nine positions and at random places; the least energy beside them."""

import itertools
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.examinations.examination import Distances, Examination, Findings
from active_binocular_vision.examinations.listing import (
    DisplacementPlane,
    displacement_plane,
    tilt_per_vergence,
)
from active_binocular_vision.examinations.measure import SHARE, key, measure
from active_binocular_vision.examinations.posture import ERROR_AXES, Posture
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.session import Session, check_looks_at_targets, session_of
from active_binocular_vision.learners.shown import Shown
from experiment_manager.measures.criteria import criteria_of
from experiment_manager.measures.metrics import antagonist_names, silent_below
from experiment_manager.measures.yoked import SharedChange, shared_change, yoked_names
from eye_plant import EyePlantConfig
from eye_plant.mechanics.oculomotor import Oculomotor
from lockstep import (
    ALL_MUSCLES,
    COMMAND_SPACES,
    MUSCLE_NAMES,
    SIDES,
    InputError,
    generator,
    setting,
)
from lockstep.machine.progress_lines import progress

Array = NDArray[np.float64]

# Azimuth (right) and elevation, row by row as a chart shows them.
NINE_POSITIONS_DEG = np.array([(a, e) for e in (8.0, 0.0, -8.0) for a in (-8.0, 0.0, 8.0)])
LEARNED, LEAST = "learned", "least"
_LARGEST_RANDOM_DEG = 10.0
# The same places for all runs, so that they compare.
_SEED = 0
_N_PICTURES = 5
# A plane through three points has no thickness.
_FEWEST_GAZES = 4


@dataclass(frozen=True)
class NinePositionsOptions(Distances):
    """Where the eyes look; the right eye may see black, since the target is in the left picture."""

    covered: str = setting("", "eye that sees black", choices=("", "right"))
    n_random: int = setting(40, "random targets at each distance", least=4)


# Rows

_GAZE = tuple(f"{side}_{angle}" for side in SIDES for angle in ("azimuth", "elevation"))


_OF_GAZE: dict[str, Any] = {
    "columns": tuple(f"{name}_deg" for name in _GAZE),
    "labels": ("left az.", "el.", "right az.", "el."),
}
_OF_ERRORS: dict[str, Any] = {
    "columns": tuple(f"{axis}_error_deg" for axis in ERROR_AXES),
    "labels": ("horizontal", "vertical", "cyclo"),
}


@dataclass(frozen=True, kw_only=True)
class LookRow:
    """Eyes at the end of one look at one target, or with the least energy that holds it.

    places: nine or random; eyes: learned or least; stimulus: null for the least energy.
    """

    places: str = key("places")
    eyes: str = key("eyes")
    object_distance_m: float = key("distance", "m")
    target_azimuth_deg: float = key("azimuth", "deg")
    target_elevation_deg: float = key("elevation", "deg")
    stimulus: int | None = key("stimulus")
    wanted_gaze_deg: Array = measure(
        "deg", "wanted gaze", columns=tuple(f"wanted_{name}_deg" for name in _GAZE)
    )
    gaze_deg: Array = measure("deg", "gaze", 2, **_OF_GAZE)
    torsion_deg: Array = measure(
        "deg", "torsion", columns=tuple(f"{side}_torsion_deg" for side in SIDES)
    )
    errors_deg: Array = measure("deg", "errors", **_OF_ERRORS)
    missed_deg: float = measure("deg", "missed")
    metabolic_rate_w: float = measure("W", "C", 4)
    activations: Array = measure("", "activation", columns=MUSCLE_NAMES)


@dataclass(frozen=True, kw_only=True)
class PositionRow:
    """One of the nine positions, medians over pictures; least C null where it is not reached."""

    object_distance_m: float = key("distance", "m")
    target_azimuth_deg: float = key("azimuth", "deg")
    target_elevation_deg: float = key("elevation", "deg")
    missed_deg: float = measure("deg", "missed")
    gaze_deg: Array = measure("deg", "gaze", 2, **_OF_GAZE)
    errors_deg: Array = measure("deg", "errors", **_OF_ERRORS)
    metabolic_rate_w: float = measure("W", "C", 4)
    least_metabolic_rate_w: float = measure("W", "least C", 4)
    cost_ratio: float = measure("", "ratio", 2)


@dataclass(frozen=True, kw_only=True)
class Medians:
    """Of absolute values: errors and C over all looks, the least C and the ratio over positions."""

    missed_deg: float = measure("deg", "missed")
    errors_deg: Sequence[float] = measure("deg", "errors", **_OF_ERRORS)
    metabolic_rate_w: float = measure("W", "C", 4)
    least_metabolic_rate_w: float = measure("W", "least C", 4)
    cost_ratio: float = measure("", "ratio", 2)


@dataclass(frozen=True, kw_only=True)
class DistanceRow(Medians):
    """Medians at one distance; null: over all distances."""

    object_distance_m: float | None = key("distance", "m")


@dataclass(frozen=True, kw_only=True)
class NinePositionsSummary(Medians):
    """Medians over all distances; share_silent: of the gazes, one of two antagonists is silent."""

    share_silent: float = measure(SHARE, "antagonist silent")


@dataclass(frozen=True, kw_only=True)
class SilenceRow:
    """Sherrington's law: of two antagonists, or of all pairs together.

    share_silent, share_silent_in_optimum: of the gazes at which one of both is silent;
    share_optimally_silent: of the muscles that are silent with the least energy, how many are
    silent in these eyes, over all gazes; null where none is; n_silent_in_optimum: muscles that are,
    over all gazes.
    """

    antagonists: str = key("antagonists")
    share_silent: float = measure(SHARE, "one silent")
    share_silent_in_optimum: float = measure(SHARE, "with least energy")
    share_optimally_silent: float | None = measure(SHARE, "the same silent")
    n_silent_in_optimum: int = measure("", "of cases", 0)


@dataclass(frozen=True, kw_only=True)
class PlaneRow:
    """Displacement plane of one eye; null where too few gazes are reached."""

    eyes: str = key("eyes")
    side: str = key("eye")
    object_distance_m: float = key("distance", "m")
    offset_deg: float | None = measure("deg", "offset")
    temporal_tilt_deg: float | None = measure("deg", "temporal tilt")
    upward_tilt_deg: float | None = measure("deg", "upward tilt")
    thickness_deg: float | None = measure("deg", "thickness")


@dataclass(frozen=True, kw_only=True)
class TiltRow:
    """Temporal tilt of the planes per deg of vergence; null with less than two planes."""

    eyes: str = key("eyes")
    left: float | None = measure("", "left eye")
    right: float | None = measure("", "right eye")
    mean: float | None = measure("", "mean")


def _shared(measure_name: str) -> Any:
    columns = tuple(f"{eyes}_{measure_name}" for eyes in (LEARNED, LEAST))
    labels = tuple(f"{measure_name}, {eyes}" for eyes in (LEARNED, LEAST))
    return measure("", measure_name, columns=columns, labels=labels)


@dataclass(frozen=True, kw_only=True)
class YokedRow:
    """Hering's law: two yoked muscles at the random places."""

    muscles: str = key("yoked muscles")
    correlation: Sequence[float] = _shared("correlation")
    slope: Sequence[float] = _shared("slope")


# Looking


@dataclass(frozen=True)
class Gazes:
    """Where eyes were to look, and what they did in the end.

    targets_deg: (n, 2) azimuth and elevation from the left eye; pictures: (n, n_pictures) numbers
    of those that were shown; wanted_gaze_deg: (n_distances, n, 2, 2) of eyes that look there; eyes:
    (n_distances, n, n_pictures) the learners' own; optimum: (n_distances, n) those with the least
    energy.
    """

    targets_deg: Array
    distances_m: tuple[float, ...]
    pictures: NDArray[np.int64]
    wanted_gaze_deg: Array
    eyes: Posture
    optimum: Posture


@dataclass(frozen=True)
class NinePositionsTraces:
    """nine: each position with each picture; random: each place with one picture."""

    plant: EyePlantConfig
    covered: str
    nine: Gazes
    random: Gazes


def random_targets_deg(n_targets: int) -> Array:
    """Draw azimuth and elevation (n, 2), each uniform within 10 deg."""
    draws = (generator(_SEED, "position", i) for i in range(n_targets))
    drawn = [draw.uniform(-_LARGEST_RANDOM_DEG, _LARGEST_RANDOM_DEG, 2) for draw in draws]
    return np.array(drawn).reshape(n_targets, 2)


class _Looking:
    """Learners' eyes and eyes with the least energy, before the same targets."""

    def __init__(self, session: Session, covered: str) -> None:
        learners = session.learners
        self.n_iterations = learners.manager.iterations_per_trial
        self._session, self._covered = session, covered
        self._turns_deg = learners.plant.camera.turns_deg
        self._commanded = learners.manager.space.indices
        self._eyes = Oculomotor(learners.plant.mechanics)
        self._correct = session.correct(0.0)

    def at(
        self, targets_deg: Array, distances_m: tuple[float, ...], pictures: NDArray[np.int64]
    ) -> Gazes:
        """Look at all targets (n, 2) from all distances; pictures: (n, n_pictures) for each."""
        gazes = list(itertools.product(distances_m, zip(targets_deg, pictures, strict=True)))
        wanted_deg: list[Array] = []
        eyes: list[Posture] = []
        optimum: list[Posture] = []
        for distance_m, (target_deg, numbers) in progress(
            gazes, file=sys.stderr, desc="nine positions", unit="gaze"
        ):
            target = target_deg.tolist()
            wanted_deg.append(self._correct.wanted_gaze_deg(distance_m, target))
            eyes += self._looks(target, distance_m, numbers.tolist())
            optimum.append(self._least(target, distance_m))
        shape = len(distances_m), len(targets_deg)
        return Gazes(
            targets_deg,
            distances_m,
            pictures,
            np.reshape(wanted_deg, (*shape, 2, 2)),
            Posture.stacked(eyes, (len(distances_m), *pictures.shape)),
            Posture.stacked(optimum, shape),
        )

    def _looks(
        self, target_deg: Sequence[float], distance_m: float, pictures: Sequence[int]
    ) -> Iterator[Posture]:
        """Yield where the eyes end before each picture; each look begins straight ahead."""
        for i_picture in pictures:
            eyes = self._session.eyes_as_healthy(i_picture, distance_m)
            eyes.look(self.n_iterations, covered=self._covered, target_deg=target_deg)
            yield self._posture(self._session.loop.plant.oculomotor, target_deg, distance_m)

    def _least(self, target_deg: Sequence[float], distance_m: float) -> Posture:
        """Return the cheapest posture without errors, cycloversion being free."""
        try:
            least = self._correct.least(distance_m, target_deg)
        except InputError:
            return Posture.unreached()
        self._eyes.settle(least.activations)
        return self._posture(self._eyes, target_deg, distance_m)

    def _posture(self, eyes: Oculomotor, target_deg: Sequence[float], distance_m: float) -> Posture:
        return Posture.of(eyes, self._turns_deg, self._commanded, target_deg, distance_m)


def _examine(learners: FrozenLearners, shown: Shown, options: NinePositionsOptions) -> Findings:
    """Let the eyes look; each look is an episode that begins straight ahead."""
    check_looks_at_targets(learners, shown, "--nine-positions")
    with session_of(learners, shown, _N_PICTURES) as session:
        looking = _Looking(session, options.covered)
        n_pictures, distances_m = session.n_pictures, options.distances_m
        each = np.tile(np.arange(n_pictures), (len(NINE_POSITIONS_DEG), 1))
        in_turn = np.arange(options.n_random)[:, None] % n_pictures
        nine = looking.at(NINE_POSITIONS_DEG, distances_m, each)
        random = looking.at(random_targets_deg(options.n_random), distances_m, in_turn)
    traces = NinePositionsTraces(learners.plant, options.covered, nine, random)
    covered = f", {options.covered} eye covered" if options.covered else ""
    silences = silences_of(traces)
    planes = {LEARNED: planes_of_eyes(traces), LEAST: planes_of_optimum(traces)}
    return Findings(
        n_stimuli=n_pictures,
        summary=NinePositionsSummary(
            **_medians(nine, [*range(len(distances_m))]),
            share_silent=silences[-1].share_silent if silences else np.nan,
        ),
        tables={
            "positions": [*_positions(nine)],
            "distances": [*_distances(nine)],
            "antagonists": silences,
            "planes": [row for eyes, of in planes.items() for row in _plane_rows(eyes, of)],
            "tilts": [_tilts(eyes, of) for eyes, of in planes.items()],
            "yoked": _yoked(random),
            "looks": [*_looks("nine", nine), *_looks("random", random)],
        },
        titles={
            "positions": f"Medians over pictures after {looking.n_iterations} iterations{covered}",
            "distances": "Medians over pictures and positions, of absolute values",
            "antagonists": "Silent antagonists at the nine positions",
            "planes": "Displacement planes of nine positions and random places",
            "tilts": "Temporal tilt of the plane per deg of vergence",
            "yoked": "Yoked muscles at random places",
        },
        traces=traces,
    )


# Measures


def _looks(places: str, gazes: Gazes) -> Iterator[LookRow]:
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


def _positions(nine: Gazes) -> Iterator[PositionRow]:
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


def _distances(nine: Gazes) -> Iterator[DistanceRow]:
    for i, distance_m in enumerate(nine.distances_m):
        yield DistanceRow(object_distance_m=distance_m, **_medians(nine, [i]))
    yield DistanceRow(object_distance_m=None, **_medians(nine, [*range(len(nine.distances_m))]))


def _medians(nine: Gazes, i_distances: Sequence[int]) -> dict[str, Any]:
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


def silences_of(traces: NinePositionsTraces) -> list[SilenceRow]:
    """Return the measures of antagonists at the nine positions that the least energy reaches."""
    optimum = traces.nine.optimum.activations
    reached = np.isfinite(optimum).all(axis=-1)
    if not reached.any():
        return []
    of_eyes = traces.nine.eyes.activations[reached]
    return silences(is_silent(of_eyes, traces.plant), is_silent(optimum[reached], traces.plant))


def silences(silent: NDArray[np.bool_], optimum: NDArray[np.bool_]) -> list[SilenceRow]:
    """Return the measures of each two antagonists, and of "all" as the last.

    silent: (n, n_pictures, 12) of the eyes at n gazes; optimum: (n, 12) of the least energy.
    """
    pairs = antagonist_names(COMMAND_SPACES[ALL_MUSCLES])
    indices = np.array([[MUSCLE_NAMES.index(name) for name in names] for names in pairs])
    chosen = {"-".join(names): i[None] for names, i in zip(pairs, indices, strict=True)}
    return [
        _silence(name, silent[..., i], optimum[..., i])
        for name, i in (chosen | {"all": indices}).items()
    ]


def _silence(name: str, silent: NDArray[np.bool_], optimum: NDArray[np.bool_]) -> SilenceRow:
    """Return the measures of k pairs; silent: (n, n_pictures, k, 2), optimum: (n, k, 2)."""
    both = np.broadcast_to(optimum[:, None], silent.shape)
    n_cases = int(optimum.sum())
    return SilenceRow(
        antagonists=name,
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


def _plane_rows(eyes: str, planes: Mapping[str, Planes]) -> Iterator[PlaneRow]:
    names = "offset_deg", "temporal_tilt_deg", "upward_tilt_deg", "thickness_deg"
    for side, of_eye in planes.items():
        for distance_m, plane in of_eye.by_distance.items():
            measures = vars(plane) if plane else dict.fromkeys(names)
            yield PlaneRow(eyes=eyes, side=side, object_distance_m=distance_m, **measures)


def _tilts(eyes: str, planes: Mapping[str, Planes]) -> TiltRow:
    left, right = (planes[side].tilt_per_vergence for side in SIDES)
    mean = None if left is None or right is None else (left + right) / 2.0
    return TiltRow(eyes=eyes, left=left, right=right, mean=mean)


def _yoked(random: Gazes) -> list[YokedRow]:
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


NINE_POSITIONS = Examination(
    name="nine-positions",
    text="show nine gaze targets at three distances to eyes that make saccades: Hess chart, energy"
    " beside the least, and the laws of Sherrington, Listing and Hering",
    examine=_examine,
    summary=NinePositionsSummary,
    options=NinePositionsOptions,
    version=2,
)
