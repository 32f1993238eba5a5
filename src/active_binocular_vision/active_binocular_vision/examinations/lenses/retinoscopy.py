"""Dynamic retinoscopy: where the retina of each eye is in focus while both look at the plane.

A retinoscope finds the distance that is conjugate to the retina; here it is known. The lag is the
dioptres of the plane's distance less those in focus: above 0 where an eye is focused too far. Light
in the middle of the spectrum counts. With cycloplegia, the lag less the plane's dioptres is the
refraction.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from active_binocular_vision.examinations.contract.declared import DECLARED, RetinoscopyOptions
from active_binocular_vision.examinations.contract.examination import Examination, Findings
from active_binocular_vision.examinations.contract.measure import Quartiles, key, measure
from active_binocular_vision.examinations.contract.trial_frame import behind
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.session import (
    check_has_lenses,
    check_shows_pictures,
    session_of,
)
from active_binocular_vision.learners.shown import Shown
from lockstep import SIDES

_N_PICTURES = 5
_N_ITERATIONS = 20


@dataclass(frozen=True, kw_only=True)
class LagRow:
    """One eye at one distance, over pictures."""

    eye: str = key("eye")
    object_distance_m: float = key("distance", "m")
    lag_d: Quartiles = measure("D", "lag", 2, spread=True)
    accommodation_d: Quartiles = measure("D", "accommodation", 2)
    pupil_mm: Quartiles = measure("mm", "pupil", 1)


@dataclass(frozen=True, kw_only=True)
class RetinoscopySummary:
    """Medians over pictures and distances."""

    lag_d: Sequence[float] = measure(
        "D",
        "lag",
        2,
        columns=tuple(f"{side}_lag_d" for side in SIDES),
        labels=tuple(f"lag {side}" for side in SIDES),
    )


def _examine(learners: FrozenLearners, shown: Shown, options: RetinoscopyOptions) -> Findings:
    """Let both eyes look at each picture at each distance."""
    check_has_lenses(learners, "--retinoscopy")
    check_shows_pictures(shown, "--retinoscopy")
    rows, lags_d = [], []
    with session_of(behind(learners, options, "--retinoscopy"), shown, _N_PICTURES) as session:
        for distance_m in options.distances_m:
            seen = [
                session.eyes(i, distance_m).look(_N_ITERATIONS).lens_state
                for i in range(session.n_pictures)
            ]
            lag_d = np.array([-lenses.error_d(distance_m) for lenses in seen])
            accommodation_d = np.array([lenses.accommodation_d for lenses in seen])
            pupil_mm = np.array([1e3 * lenses.pupil_m for lenses in seen])
            lags_d.append(lag_d)
            rows += [
                LagRow(
                    eye=side,
                    object_distance_m=distance_m,
                    lag_d=Quartiles.of(lag_d[:, i]),
                    accommodation_d=Quartiles.of(accommodation_d[:, i]),
                    pupil_mm=Quartiles.of(pupil_mm[:, i]),
                )
                for i, side in enumerate(SIDES)
            ]
        n_stimuli = session.n_pictures
    return Findings(
        n_stimuli=n_stimuli,
        summary=RetinoscopySummary(lag_d=np.median(np.concatenate(lags_d), axis=0).tolist()),
        tables={"eyes": rows},
        titles={"eyes": ""},
        # 211 patients before presbyopia, with the monocular estimate method.
        notes="Human eyes at 0.4 m: a third of a dioptre, median 0.25 D (Tassinari 2002).",
    )


RETINOSCOPY = Examination(
    declared=DECLARED["retinoscopy"],
    examine=_examine,
    summary=RetinoscopySummary,
)
