"""The landscape of the reward: how well pictures are coded, over the vergence error."""

import sys
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.examinations.code.tuning import of_scales
from active_binocular_vision.examinations.contract.declared import DECLARED, LandscapeOptions
from active_binocular_vision.examinations.contract.examination import Examination, Findings
from active_binocular_vision.examinations.contract.measure import SHARE, key, measure
from active_binocular_vision.learners.basis_functions import left_share
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.session import (
    Session,
    check_shows_pictures,
    session_of,
)
from active_binocular_vision.learners.shown import Shown
from lockstep import InputError
from lockstep.machine.progress_lines import progress
from lockstep.scales import SCALES

Array = NDArray[np.float64]

_N_PICTURES = 10


@dataclass(frozen=True, kw_only=True)
class ErrorRow:
    """Reconstruction error with a vergence error, mean over pictures and distances.

    Null where no muscle activation gives the vergence, or none at which the eyes have one rest.
    """

    vergence_error_deg: float = key("vergence error", "deg")
    reconstruction_error: Sequence[float] = of_scales(
        "", "reconstruction_error", "reconstruction error"
    )


@dataclass(frozen=True, kw_only=True)
class LandscapeSummary:
    """What a frozen dictionary makes of pictures seen with wrong vergence.

    depth: how much the best vergence error saves against the mean of all, as a share; 0 is flat.
    left_share_in_code: of all these pictures. gabor_share_by_use: of the squared coefficients in
    that code, those of Gabor functions.
    """

    depth: float | None = measure("", "depth", 2)
    left_share_in_code: float | None = measure(SHARE, "left eye in code")
    gabor_share_by_use: Sequence[float] = of_scales(SHARE, "gabor_share_by_use", "Gabor by use")


def depth_of(errors: Array) -> float:
    """Return 1 - least / mean of the errors (n,) of all scales together; nan without any."""
    total = errors[~np.isnan(errors)]
    return float(1.0 - total.min() / total.mean()) if len(total) else float("nan")


def reward_landscape(
    session: Session, distances_m: Sequence[float], errors_deg: Sequence[float]
) -> tuple[Array, NDArray[np.float64]]:
    """Return reconstruction errors (n_errors, n_scales) and features (n_scales, n_bases) of all.

    Nothing is learned. The eyes are held at the cheapest pair of activations for each vergence, so
    that eyes of unequal muscles point where these let them. Errors are means over pictures and
    distances, nan where the eyes do not reach the vergence at one of the distances.
    """
    n_pictures = session.n_pictures
    coder = session.loop.coder.config
    n_scales = len(coder.scales.all)
    errors = np.full((len(errors_deg), len(distances_m), n_pictures, n_scales), np.nan)
    features = np.zeros((n_scales, coder.n_bases))
    shown = progress(errors_deg, file=sys.stderr, desc="landscape", unit="error")
    for i_error, error_deg in enumerate(shown):
        for i_distance, distance_m in enumerate(distances_m):
            try:
                codes = [
                    session.eyes_at_vergence(i, distance_m, error_deg).code()
                    for i in range(n_pictures)
                ]
            except InputError:
                continue
            for i, code in enumerate(codes):
                errors[i_error, i_distance, i] = code.reconstruction_error
                features += code.features
    reached = ~np.isnan(errors).any(axis=(1, 2, 3))
    means = np.full((len(errors), n_scales), np.nan)
    means[reached] = errors[reached].mean(axis=(1, 2))
    return means, features


def _examine(learners: FrozenLearners, shown: Shown, options: LandscapeOptions) -> Findings:
    """Measure the landscape before each picture."""
    check_shows_pictures(shown, "--landscape")
    errors_deg = options.vergence_errors_deg
    with session_of(learners, shown, _N_PICTURES) as session:
        errors, features = reward_landscape(session, options.distances_m, errors_deg)
    use = features / np.maximum(features.sum(axis=1, keepdims=True), np.finfo(float).tiny)
    n_shown = len(SCALES)
    summary = LandscapeSummary(
        depth=depth_of(errors.sum(axis=1)),
        left_share_in_code=left_share(features, learners.atoms),
        gabor_share_by_use=[
            float(of[tuned.is_gabor].sum()) for of, tuned in zip(use, learners.tunings, strict=True)
        ][:n_shown],
    )
    rows = [
        ErrorRow(vergence_error_deg=error_deg, reconstruction_error=of[:n_shown])
        for error_deg, of in zip(errors_deg, errors, strict=True)
    ]
    return Findings(
        n_stimuli=session.n_pictures,
        summary=summary,
        tables={"errors": rows},
        titles={"summary": "", "errors": "Mean over stimuli and distances"},
    )


LANDSCAPE = Examination(
    declared=DECLARED["landscape"],
    examine=_examine,
    summary=LandscapeSummary,
)
