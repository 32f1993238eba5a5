"""Where the eyes rest at the end of a test's trials, and the parts of the error that is left.

A trial rests at the mean error of its second half. Trials of the same picture at the same distance
start from other errors and activations: what they have in common is a property of the picture.
"""

from dataclasses import dataclass

import numpy as np

from experiment_manager import Trials
from experiment_manager.measures.metrics import ARRIVED_DEG

# Distances to the resting place over which the approach is measured: above restlessness, and below
# one pixel of the coarse scale.
_NEAR_DEG = (0.03, 0.3)


@dataclass(frozen=True)
class RestingPlaces:
    """The resting places of the trials that have arrived; deg, None where not known.

    n_trials: that have arrived. bias_deg: their median. spread_deg: their standard deviation.
    within_deg: standard deviation among trials of one stimulus and distance, median over these
    pairs. between_deg: standard deviation of the pairs' means. restlessness_deg: standard deviation
    over time of a trial that rests, median over trials. share_left: of a small distance to the
    resting place, after one more iteration (least squares; 0 arrives at once, 1 never).
    """

    n_trials: int
    bias_deg: float | None = None
    spread_deg: float | None = None
    within_deg: float | None = None
    between_deg: float | None = None
    restlessness_deg: float | None = None
    share_left: float | None = None


def resting_places(trials: Trials) -> RestingPlaces:
    """Return the resting places of a test."""
    n = trials.n_iterations
    error_deg = trials.vergence_error_deg
    resting = error_deg[:, n // 2 + 1 :]
    place_deg = resting.mean(axis=1)
    arrived = np.abs(place_deg) < ARRIVED_DEG
    if not arrived.any():
        return RestingPlaces(0)
    within_deg, between_deg = _spreads(trials.chosen(arrived), place_deg[arrived])
    off_deg = (error_deg - place_deg[:, None])[arrived, : n // 2 + 1]
    return RestingPlaces(
        n_trials=int(arrived.sum()),
        bias_deg=float(np.median(place_deg[arrived])),
        spread_deg=float(place_deg[arrived].std()),
        within_deg=within_deg,
        between_deg=between_deg,
        restlessness_deg=float(np.median(resting[arrived].std(axis=1))),
        share_left=_share_left(off_deg),
    )


def _spreads(trials: Trials, place_deg: np.ndarray) -> tuple[float | None, float | None]:
    pairs = np.stack([trials.stimulus, trials.object_distance_m], axis=1)
    _, number = np.unique(pairs, axis=0, return_inverse=True)
    places = [place_deg[number.ravel() == i] for i in range(number.max() + 1)]
    places = [among for among in places if len(among) > 1]
    if not places:
        return None, None
    within_deg = float(np.median([among.std() for among in places]))
    return within_deg, float(np.std([among.mean() for among in places]))


def _share_left(off_deg: np.ndarray) -> float | None:
    """off_deg: (n_trials, n) signed distance to the resting place, before that was reached."""
    before, after = off_deg[:, :-1], off_deg[:, 1:]
    near = (np.abs(before) > _NEAR_DEG[0]) & (np.abs(before) < _NEAR_DEG[1])
    before, after = before[near], after[near]
    return float((before * after).sum() / (before**2).sum()) if near.any() else None
