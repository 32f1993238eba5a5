"""What saccades reach, and what vergence makes of it: measures of the fixations of a test.

A fixation begins with two saccades to its target; vergence follows. All fixations of all trials are
pooled. The target's place is that from the line of sight of the eye that leads: the left one,
unless saccades leave it more than a degree off and the right one less so.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from experiment_manager.measures.results import Spread
from experiment_manager.measures.trials import ERROR_NAMES, Trials
from lockstep.wire.topics import GIVEN_TARGET_NAMES, N_SACCADES

# Vergence is judged, and gaze with it, so many iterations after the saccades.
VERGED = 5
# More than saccades miss (results/gaze.md).
_LOST_DEG = 1.0

Places = Callable[[int | np.ndarray], np.ndarray]


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
    verged_deg = target_deg(verged - begin)
    known = np.isfinite(horizontal_deg) & np.isfinite(verged_deg).all(axis=2).ravel()
    if not known.any():
        return {}
    missed_deg = {
        f"after_{k}": _length(target_deg(k)).ravel()[known] for k in range(1, N_SACCADES + 1)
    }
    moved_deg = _length(verged_deg - target_deg(N_SACCADES)).ravel()[known]
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


def _of_leading_eye(trials: Trials, begin: np.ndarray) -> tuple[np.ndarray, Places]:
    """Return whether the right eye leads (n_trials, n_fixations), and where the leading one sees.

    begin: (n_fixations,) iterations at which fixations begin. The second is a function of the
    iterations since then, of all fixations or of each; it returns (n_trials, n_fixations, 2), the
    target's place from that eye's line of sight.
    """
    columns = np.stack([trials.column(name) for name in GIVEN_TARGET_NAMES], axis=-1)
    places_deg = columns.reshape(*columns.shape[:-1], 2, 2)
    left_deg, right_deg = np.moveaxis(_length(places_deg[:, begin + N_SACCADES]), -1, 0)
    leads = (left_deg > _LOST_DEG) & (right_deg < left_deg)

    def target_deg(since: int | np.ndarray) -> np.ndarray:
        left_deg, right_deg = np.moveaxis(places_deg[:, begin + since], -2, 0)
        return np.where(leads[..., None], right_deg, left_deg)

    return leads, target_deg


def _length(vectors: np.ndarray) -> np.ndarray:
    return np.asarray(np.linalg.norm(vectors, axis=-1))
