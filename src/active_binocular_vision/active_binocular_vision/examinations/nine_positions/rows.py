"""Rows of what nine positions show: looks, medians, antagonists, planes, yoked muscles."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.examinations.contract.measure import SHARE, key, measure
from active_binocular_vision.examinations.nine_positions.posture import ERROR_AXES
from lockstep import MUSCLE_NAMES, SIDES

Array = NDArray[np.float64]

LEARNED, LEAST = "learned", "least"

_GAZE = tuple(f"{side}_{angle}" for side in SIDES for angle in ("azimuth", "elevation"))


_OF_GAZE: dict[str, Any] = {
    "columns": tuple(f"{name}_deg" for name in _GAZE),
    "labels": ("left az.", "el.", "right az.", "el."),
}
_OF_ERRORS: dict[str, Any] = {
    "columns": tuple(f"{axis}_error_deg" for axis in ERROR_AXES),
    "labels": ("horizontal", "vertical", "cyclo"),
}


def _shared(measure_name: str) -> Any:
    columns = tuple(f"{eyes}_{measure_name}" for eyes in (LEARNED, LEAST))
    labels = tuple(f"{measure_name}, {eyes}" for eyes in (LEARNED, LEAST))
    return measure("", measure_name, columns=columns, labels=labels)


def _active(name: str, label: str) -> Any:
    ways = "both", "one", "none"
    columns = tuple(f"{name}_{way}_active" for way in ways)
    return measure(SHARE, label, columns=columns, labels=tuple(f"{way} {label}" for way in ways))


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
    """Medians over all distances.

    active: of the pairs of antagonists at all gazes the shares of which both, one or none is
    active; active_muscles: median of their number.
    """

    active: Sequence[float] = _active("share", "active")
    active_muscles: float = measure("", "active muscles", 1)


@dataclass(frozen=True, kw_only=True)
class AntagonistRow:
    """Sherrington's law: of two antagonists, or of all pairs together.

    active, active_in_optimum: shares of the gazes at which both, one or none is active; slope: of
    the lesser over the greater activation, across gaze; share_optimally_silent: of the muscles that
    are silent with the least energy, how many are silent in these eyes, over all gazes; null where
    none is; n_silent_in_optimum: muscles that are, over all gazes.
    """

    antagonists: str = key("antagonists")
    active: Sequence[float] = _active("share", "active")
    active_in_optimum: Sequence[float] = _active("optimal_share", "with least energy")
    slope: Sequence[float] = _shared("slope")
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


@dataclass(frozen=True, kw_only=True)
class YokedRow:
    """Hering's law: two yoked muscles at the random places."""

    muscles: str = key("yoked muscles")
    correlation: Sequence[float] = _shared("correlation")
    slope: Sequence[float] = _shared("slope")
