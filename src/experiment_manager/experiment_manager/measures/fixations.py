"""What saccades reach, and what vergence makes of it: measures of the fixations of a test.

A fixation begins with two saccades to its target; vergence follows. All fixations of all trials are
pooled. The target's place is that from the left eye's line of sight.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any, Self

import numpy as np

from experiment_manager.measures.trials import ERROR_NAMES, Trials
from lockstep.wire.topics import N_SACCADES, TARGET_NAMES

# Vergence is judged, and gaze with it, so many iterations after the saccades.
VERGED = 5


@dataclass(frozen=True)
class Spread:
    """Median and 90th percentile of absolute values."""

    median: float
    p90: float

    @classmethod
    def of(cls, values: np.ndarray) -> Self:
        """Return those of values (n,), n > 0."""
        median, p90 = np.quantile(np.abs(values), (0.5, 0.9)).tolist()
        return cls(median, p90)


@dataclass(frozen=True)
class FixationMeasures:
    """Measures of fixations, as in docs/measures.md, with the names of results.json.

    saccade_error_deg: angle between line of sight and target after each of the saccades;
    gaze_drift_deg: how far the line of sight moves over VERGED iterations of vergence; what comes
    next: errors about all axes after those, and the share of fixations within one pixel, sideways
    and up.
    """

    saccade_error_deg: Mapping[str, Spread]
    gaze_drift_deg: Spread
    fixated_horizontal_error_deg: Spread
    fixated_vertical_error_deg: Spread
    fixated_cyclovergence_error_deg: Spread
    share_fixated_within_1_px: float

    def to_json(self) -> dict[str, Any]:
        """Return the entries of results.json."""
        return asdict(self)

    @classmethod
    def from_json(cls, document: Mapping[str, Any]) -> Self:
        """Return what `to_json` was called on; KeyError, TypeError or ValueError for other data."""
        spreads = {f.name: Spread(**document[f.name]) for f in fields(cls) if f.type is Spread}
        after = {name: Spread(**values) for name, values in document["saccade_error_deg"].items()}
        share = float(document["share_fixated_within_1_px"])
        return cls(saccade_error_deg=after, share_fixated_within_1_px=share, **spreads)


def fixation_measures(
    trials: Trials, fixation_iterations: int, px_deg: float
) -> FixationMeasures | None:
    """Return the measures of a test's fixations; None where none was recorded.

    fixation_iterations: of each; px_deg: the visual angle of one pixel.
    """
    begin = np.arange(0, trials.n_iterations, fixation_iterations)
    verged = begin + min(N_SACCADES + VERGED, fixation_iterations - 1)
    target_deg = np.stack([trials.column(name) for name in TARGET_NAMES], axis=-1)
    horizontal_deg, vertical_deg, torsional_deg = (
        trials.column(name)[:, verged].ravel() for name in ERROR_NAMES
    )
    known = np.isfinite(horizontal_deg) & np.isfinite(target_deg[:, verged]).all(axis=2).ravel()
    if not known.any():
        return None
    missed_deg = {
        f"after_{k}": _length(target_deg[:, begin + k]).ravel()[known]
        for k in range(1, N_SACCADES + 1)
    }
    moved_deg = _length(target_deg[:, verged] - target_deg[:, begin + N_SACCADES]).ravel()[known]
    within = np.maximum(np.abs(horizontal_deg), np.abs(vertical_deg))[known] < px_deg
    return FixationMeasures(
        saccade_error_deg={name: Spread.of(values) for name, values in missed_deg.items()},
        gaze_drift_deg=Spread.of(moved_deg),
        fixated_horizontal_error_deg=Spread.of(horizontal_deg[known]),
        fixated_vertical_error_deg=Spread.of(vertical_deg[known]),
        fixated_cyclovergence_error_deg=Spread.of(torsional_deg[known]),
        share_fixated_within_1_px=float(within.mean()),
    )


def _length(vectors: np.ndarray) -> np.ndarray:
    return np.asarray(np.linalg.norm(vectors, axis=-1))
