"""Where looks begin, and where they are to end: nine positions of the clinic, random places."""

import dataclasses
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.shown import Shown
from experiment_manager.experiment.starts import gaze_inverse
from eye_plant.inverse.gaze import ERRORS
from lockstep import InputError, generator

Array = NDArray[np.float64]

DISTANCES_M = (0.5, 2.0, 6.0)
# Azimuth (right) and elevation, row by row as a chart shows them.
NINE_POSITIONS_DEG = np.array([(a, e) for e in (8.0, 0.0, -8.0) for a in (-8.0, 0.0, 8.0)])
N_RANDOM = 40
_LARGEST_RANDOM_DEG = 10.0
# The same places for all runs, so that they compare.
_SEED = 0
_AHEAD_DEG = (0.0, 0.0)


def random_targets_deg(n_targets: int) -> Array:
    """Draw azimuth and elevation (n, 2), each uniform within 10 deg."""
    draws = (generator(_SEED, "position", i) for i in range(n_targets))
    drawn = [draw.uniform(-_LARGEST_RANDOM_DEG, _LARGEST_RANDOM_DEG, 2) for draw in draws]
    return np.array(drawn).reshape(n_targets, 2)


def wanted_gaze_deg(
    positions_m: Array, target_deg: Sequence[float] | Array, distance_m: float
) -> Array:
    """Return azimuth (right) and elevation (2, 2) of left and right eye that look at a target.

    positions_m: (2, 3) of the eyes, x forward, y left, z up; target_deg: (2,) azimuth and elevation
    from the left eye of a point on the plane at x = distance_m.
    """
    azimuth, elevation = np.radians(target_deg)
    forward = np.array([1.0, -np.tan(azimuth), np.tan(elevation) / np.cos(azimuth)])
    left_m, right_m = positions_m
    point_m = left_m + (distance_m - left_m[0]) * forward
    return np.stack([direction_deg(point_m - left_m), direction_deg(point_m - right_m)])


def direction_deg(vectors: Array) -> Array:
    """Return azimuth (right) and elevation (..., 2) of vectors (..., 3), forward, left, up."""
    forward, left, up = np.moveaxis(vectors, -1, 0)
    angles = np.arctan2(-left, forward), np.arctan2(up, np.hypot(forward, left))
    return np.degrees(np.stack(angles, axis=-1))


def wanted_angles_deg(gaze_deg: Array) -> dict[str, float]:
    """Return what GazeInverse takes for eyes whose wanted gaze is (2, 2): all angles, no errors."""
    version_deg, elevation_deg = gaze_deg.mean(axis=0).tolist()
    return dict.fromkeys(ERRORS, 0.0) | {"version": version_deg, "elevation": elevation_deg}


def check_looks_at_targets(learners: FrozenLearners, shown: Shown, option: str) -> None:
    """Raise InputError, which names the option, unless the learners can look at targets."""
    if not learners.manager.fixation_iterations:
        raise InputError(
            f"{option}: expected eyes that make saccades, as those of profile gaze, got a run with "
            "protocol.fixation_iterations 0"
        )
    if shown.random_dots or shown.stereograms is not None:
        raise InputError(f"{option}: expected pictures on a plane, got stereograms")


def activations_ahead(learners: FrozenLearners, positions_m: Array, distance_m: float) -> Array:
    """Return activations (12,) with which the left eye looks straight ahead, without errors.

    positions_m: (2, 3) of the eyes. Eyes with a palsy get what healthy ones need.
    """
    healthy = dataclasses.replace(learners, settings={}).manager
    wanted_deg = wanted_angles_deg(wanted_gaze_deg(positions_m, _AHEAD_DEG, distance_m))
    nowhere_aside = np.zeros(len(healthy.space.indices))
    inverse = gaze_inverse(healthy, healthy.mechanics)
    return inverse.activations(wanted_deg, distance_m, nowhere_aside)
