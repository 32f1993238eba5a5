"""Stereo threshold: how small a disparity still decides which way the eyes turn.

Eyes that look a little before or behind a random-dot stereogram see nothing but a disparity. The
first command of vergence is right if it makes the horizontal error smaller.
"""

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from experiment_manager.clinic.gratings import crossing
from experiment_manager.clinic.room import Room
from experiment_manager.run.progress_lines import progress
from lockstep.wire.topics import N_SACCADES

Array = NDArray[np.float64]

DISPARITIES_DEG = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0)
_LEAST_RIGHT = 0.75
_HORIZONTAL = 0


@dataclass(frozen=True)
class StereoCurve:
    """How often the first command of vergence is right.

    disparity_deg: (n,) size of the horizontal error, rising; right: (n,) shares of n_trials each.
    """

    disparity_deg: Array
    right: Array
    n_trials: int

    @property
    def threshold_deg(self) -> float | None:
        """Smallest disparity from which on 75 % are right, None if the largest one fails.

        Linear over the logarithm of the disparity; at least the smallest one shown.
        """
        if self.right[-1] < _LEAST_RIGHT:
            return None
        # Read from the largest disparity down, it is where the share first falls below the level.
        log_inverse = -np.log(self.disparity_deg[::-1])
        falling = self.right[::-1]
        failed = np.flatnonzero(falling < _LEAST_RIGHT)
        n = int(failed[0]) + 1 if len(failed) else len(falling)
        inverse = crossing(log_inverse[:n], falling[:n], _LEAST_RIGHT)
        return None if inverse is None else 1.0 / inverse


def stereo_curve(room: Room, distances_m: Sequence[float]) -> StereoCurve:
    """Return how often the first command is right, over disparities of either sign.

    room: with random-dot stereograms. All stereograms and distances count alike.
    """
    signed_deg = [sign * d for d in DISPARITIES_DEG for sign in (-1.0, 1.0)]
    right: list[list[bool]] = []
    for error_deg in progress(signed_deg, file=sys.stderr, desc="stereo vision", unit="part"):
        right.append(
            [
                turns_right(room, i, distance_m, error_deg)
                for i in range(room.n_pictures)
                for distance_m in distances_m
            ]
        )
    of_sizes = np.array(right).reshape(len(DISPARITIES_DEG), -1)
    return StereoCurve(np.array(DISPARITIES_DEG), of_sizes.mean(axis=1), of_sizes.shape[1])


def turns_right(room: Room, i_picture: int, distance_m: float, error_deg: float) -> bool:
    """Return whether the first command of vergence makes a horizontal error smaller.

    Eyes that make saccades look at their target already; what these leave of the error counts.
    """
    n_before = N_SACCADES if room.learners.manager.protocol.fixation_iterations else 0
    course = room.seat(i_picture, distance_m, error_deg).look(n_before + 1)
    before_deg, after_deg = course.seen_deg[n_before:, _HORIZONTAL].tolist()
    return bool((before_deg - after_deg) * math.copysign(1.0, before_deg) > 0.0)
