"""Stereo threshold: how small a disparity still decides which way the eyes turn.

Eyes that look a little before or behind a random-dot stereogram see nothing but a disparity. The
first command of vergence is right if it makes the horizontal error smaller.
"""

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.examinations.clinic.gratings import crossing
from active_binocular_vision.examinations.clinic.psychometric import (
    Psychometric,
    fitted,
    resampled,
)
from active_binocular_vision.examinations.contract.declared import DECLARED, Distances
from active_binocular_vision.examinations.contract.examination import Examination, Findings
from active_binocular_vision.examinations.contract.measure import SHARE, key, measure
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.session import Session, session_of
from active_binocular_vision.learners.shown import Shown
from lockstep import InputError
from lockstep.machine.progress_lines import progress
from lockstep.wire.topics import N_SACCADES

Array = NDArray[np.float64]

DISPARITIES_DEG = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0)
_LEAST_RIGHT = 0.75
_HORIZONTAL = 0
_N_STEREOGRAMS = 10
_ARCSEC_PER_DEG = 3600.0


@dataclass(frozen=True)
class StereoCurve:
    """How often the first command of vergence is right.

    disparity_deg: (n,) size of the horizontal error, rising; answers: (n, 2, n_pictures, k) whether
    commands are right, of eyes that converge too much and of eyes that converge too little, before
    each stereogram k times.
    """

    disparity_deg: Array
    answers: NDArray[np.bool_]

    @property
    def right_by_sign(self) -> Array:
        """Shares (2, n) of right commands of eyes that converge too much, and too little."""
        return np.asarray(self.answers.mean(axis=(2, 3)).T)

    @property
    def n_trials(self) -> int:
        """How many trials each share is of."""
        return int(np.prod(self.answers.shape[2:]))

    @property
    def right(self) -> Array:
        """Share (n,) of right commands, both signs together."""
        return np.asarray(self.right_by_sign.mean(axis=0))

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

    @cached_property
    def fit(self) -> Psychometric:
        """The psychometric function, both signs together."""
        return fitted(self.disparity_deg, self.right, 2 * self.n_trials)

    @cached_property
    def interval_deg(self) -> tuple[float, float] | None:
        """95 % interval of the fitted threshold over stereograms; None for one stereogram."""

        def threshold_deg(pictures: NDArray[np.intp]) -> float:
            of_drawn = StereoCurve(self.disparity_deg, self.answers[:, :, pictures])
            return of_drawn.fit.threshold

        return resampled(self.answers.shape[2], threshold_deg)


def stereo_curve(session: Session, distances_m: Sequence[float]) -> StereoCurve:
    """Return how often the first command is right, over disparities of either sign.

    session: with random-dot stereograms. All stereograms and distances count alike.
    """
    sizes_deg = progress(DISPARITIES_DEG, file=sys.stderr, desc="stereo vision", unit="part")
    answers = [
        [
            [
                [turns_right(session, i, distance_m, sign * size_deg) for distance_m in distances_m]
                for i in range(session.n_pictures)
            ]
            for sign in (-1.0, 1.0)
        ]
        for size_deg in sizes_deg
    ]
    return StereoCurve(np.array(DISPARITIES_DEG), np.array(answers))


def turns_right(session: Session, i_picture: int, distance_m: float, error_deg: float) -> bool:
    """Return whether the first command of vergence makes a horizontal error smaller.

    Eyes that make saccades look at their target already; what these leave of the error counts.
    """
    n_before = N_SACCADES if session.learners.manager.fixation_iterations else 0
    course = session.eyes(i_picture, distance_m, error_deg).look(n_before + 1)
    before_deg, after_deg = course.seen_deg[n_before:, _HORIZONTAL].tolist()
    return bool((before_deg - after_deg) * math.copysign(1.0, before_deg) > 0.0)


@dataclass(frozen=True, kw_only=True)
class StereoRow:
    """A disparity of either sign: shares of right first commands, of n_trials of each sign."""

    disparity_deg: float = key("disparity", "deg")
    share_right: float = measure(SHARE, "right")
    share_right_converged_too_much: float = measure(SHARE, "eyes converge too much")
    share_right_converged_too_little: float = measure(SHARE, "too little")
    n_trials: int = measure("", "trials", 0, is_shown=False)


@dataclass(frozen=True, kw_only=True)
class StereoSummary:
    """Smallest disparity from which on 75 % are right; null where the largest one fails.

    fitted_arcsec: threshold of the psychometric function that fits best; interval_arcsec: 95 %,
    over stereograms, null for one; lapse_share: of its lapses. What lies at twice the largest
    disparity or at half of the smallest may lie beyond.
    """

    threshold_deg: float | None = measure("deg", "stereo threshold")
    threshold_arcsec: float | None = measure("arcsec", "stereo threshold", 0)
    fitted_arcsec: float = measure("arcsec", "fitted threshold", 0)
    interval_arcsec: Sequence[float | None] = measure(
        "arcsec",
        "interval",
        0,
        columns=("fitted_low_arcsec", "fitted_high_arcsec"),
        labels=("from", "to"),
    )
    lapse_share: float = measure(SHARE, "lapses")


def _examine(learners: FrozenLearners, shown: Shown, options: Distances) -> Findings:
    """Measure the threshold with random dots of the run's own seed."""
    if shown.text and not shown.random_dots:
        raise InputError(f"--stereo: expected its own random-dot stereograms, got {shown.text}")
    dots = Shown(random_dots=True, n_most=shown.n_most)
    with session_of(learners, dots, _N_STEREOGRAMS) as session:
        curve = stereo_curve(session, options.distances_m)
    threshold_deg = curve.threshold_deg
    rows = zip(curve.disparity_deg, curve.right, *curve.right_by_sign, strict=True)
    summary = StereoSummary(
        threshold_deg=threshold_deg,
        threshold_arcsec=None if threshold_deg is None else threshold_deg * _ARCSEC_PER_DEG,
        fitted_arcsec=curve.fit.threshold * _ARCSEC_PER_DEG,
        interval_arcsec=[e and e * _ARCSEC_PER_DEG for e in curve.interval_deg or (None, None)],
        lapse_share=curve.fit.lapse,
    )
    return Findings(
        n_stimuli=session.n_pictures,
        summary=summary,
        tables={
            "disparities": [
                StereoRow(
                    disparity_deg=size_deg,
                    share_right=right,
                    share_right_converged_too_much=too_much,
                    share_right_converged_too_little=too_little,
                    n_trials=curve.n_trials,
                )
                for size_deg, right, too_much, too_little in rows
            ],
        },
        titles={"disparities": "First commands of vergence", "summary": ""},
        traces=curve,
    )


STEREO = Examination(
    declared=DECLARED["stereo"],
    examine=_examine,
    summary=StereoSummary,
)
