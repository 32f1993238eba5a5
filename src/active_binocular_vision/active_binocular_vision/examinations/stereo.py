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

from active_binocular_vision.examinations.gratings import crossing
from active_binocular_vision.examinations.room import Room
from experiment_manager.terminal.progress_lines import progress
from lockstep.wire.topics import N_SACCADES

Array = NDArray[np.float64]

DISPARITIES_DEG = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0)
_LEAST_RIGHT = 0.75
_HORIZONTAL = 0


@dataclass(frozen=True)
class StereoCurve:
    """How often the first command of vergence is right.

    disparity_deg: (n,) size of the horizontal error, rising; right_by_sign: (2, n) shares of right
    commands of eyes that converge too much, and of eyes that converge too little; n_trials: of each
    share.
    """

    disparity_deg: Array
    right_by_sign: Array
    n_trials: int

    @property
    def right(self) -> Array:
        """Share (n,) of right commands, both signs together."""
        return np.asarray(self.right_by_sign.mean(axis=0))

    @property
    def converging(self) -> tuple[Array, Array]:
        """Signed disparity (2 n,), rising, and the share of commands that make the eyes converge.

        Above 0 the eyes converge too little, as in GazeError.
        """
        too_much, too_little = self.right_by_sign
        signed_deg = np.concatenate([-self.disparity_deg[::-1], self.disparity_deg])
        return signed_deg, np.concatenate([1.0 - too_much[::-1], too_little])

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
    sizes_deg = progress(DISPARITIES_DEG, file=sys.stderr, desc="stereo vision", unit="part")
    places = [(i, distance_m) for i in range(room.n_pictures) for distance_m in distances_m]
    right = [
        [
            np.mean([turns_right(room, i, distance_m, sign * size_deg) for i, distance_m in places])
            for sign in (-1.0, 1.0)
        ]
        for size_deg in sizes_deg
    ]
    return StereoCurve(np.array(DISPARITIES_DEG), np.array(right).T, len(places))


def turns_right(room: Room, i_picture: int, distance_m: float, error_deg: float) -> bool:
    """Return whether the first command of vergence makes a horizontal error smaller.

    Eyes that make saccades look at their target already; what these leave of the error counts.
    """
    n_before = N_SACCADES if room.learners.manager.fixation_iterations else 0
    course = room.seat(i_picture, distance_m, error_deg).look(n_before + 1)
    before_deg, after_deg = course.seen_deg[n_before:, _HORIZONTAL].tolist()
    return bool((before_deg - after_deg) * math.copysign(1.0, before_deg) > 0.0)
