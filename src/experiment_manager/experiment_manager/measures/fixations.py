"""What saccades reach, and what vergence makes of it: measures of the fixations of a test.

A fixation begins with two saccades to its target; vergence follows. All fixations of all trials are
pooled. The target's place is that from the line of sight of the eye that leads: the left one,
unless saccades leave it more than a degree off and the right one less so.
"""

from typing import Any

import numpy as np

from experiment_manager.measures.results import Spread
from experiment_manager.measures.trials import ERROR_NAMES, Trials
from lockstep.wire.topics import N_SACCADES, RIGHT_TARGET_NAMES, TARGET_NAMES

# Vergence is judged, and gaze with it, so many iterations after the saccades.
VERGED = 5
# More than saccades miss (results/gaze.md).
_LOST_DEG = 1.0


def fixation_measures(trials: Trials, fixation_iterations: int, px_deg: float) -> dict[str, Any]:
    """Return the measures of a test's fixations by their names in Summary; none were recorded: {}.

    fixation_iterations: of each; px_deg: the visual angle of one pixel.
    """
    begin = np.arange(0, trials.n_iterations, fixation_iterations)
    verged = begin + min(N_SACCADES + VERGED, fixation_iterations - 1)
    leads, target_deg = _of_leading_eye(trials, begin)
    horizontal_deg, vertical_deg, torsional_deg = (
        trials.column(name)[:, verged].ravel() for name in ERROR_NAMES
    )
    known = np.isfinite(horizontal_deg) & np.isfinite(target_deg[:, verged]).all(axis=2).ravel()
    if not known.any():
        return {}
    missed_deg = {
        f"after_{k}": _length(target_deg[:, begin + k]).ravel()[known]
        for k in range(1, N_SACCADES + 1)
    }
    moved_deg = _length(target_deg[:, verged] - target_deg[:, begin + N_SACCADES]).ravel()[known]
    within = np.maximum(np.abs(horizontal_deg), np.abs(vertical_deg))[known] < px_deg
    return {
        "saccade_error_deg": {name: Spread.of(values) for name, values in missed_deg.items()},
        "gaze_drift_deg": Spread.of(moved_deg),
        "fixated_horizontal_error_deg": Spread.of(horizontal_deg[known]),
        "fixated_vertical_error_deg": Spread.of(vertical_deg[known]),
        "fixated_cyclovergence_error_deg": Spread.of(torsional_deg[known]),
        "share_fixated_within_1_px": float(within.mean()),
        "share_right_eye_leads": float(leads.ravel()[known].mean()),
    }


def _of_leading_eye(trials: Trials, begin: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return whether the right eye leads, and the target's place from the leading line of sight.

    begin: (n_fixations,) iterations at which fixations begin. The first is (n_trials, n_fixations),
    the second (n_trials, n_iterations + 1, 2).
    """
    left_deg, right_deg = (
        np.stack([trials.column(name) for name in names], axis=-1)
        for names in (TARGET_NAMES, RIGHT_TARGET_NAMES)
    )
    missed_deg, right_missed_deg = (
        _length(places_deg[:, begin + N_SACCADES]) for places_deg in (left_deg, right_deg)
    )
    leads = (missed_deg > _LOST_DEG) & (right_missed_deg < missed_deg)
    fixation = np.searchsorted(begin, np.arange(trials.n_iterations + 1), side="right") - 1
    return leads, np.where(leads[:, fixation, None], right_deg, left_deg)


def _length(vectors: np.ndarray) -> np.ndarray:
    return np.asarray(np.linalg.norm(vectors, axis=-1))
