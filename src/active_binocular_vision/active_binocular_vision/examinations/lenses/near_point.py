"""Near points: the plane comes nearer until the eyes no longer fuse it, or it is out of focus.

Convergence: fused as in the cover test, with both eyes open. Accommodation: as long as the error of
focus is at most half a dioptre (ours: patients report blur), of both eyes that of the better one.
The near point is the last place before this fails for good; recovery is where it succeeds again
while the plane moves away.
"""

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from active_binocular_vision.examinations.clinic.prisms import climb
from active_binocular_vision.examinations.contract.declared import DECLARED, NearPointOptions
from active_binocular_vision.examinations.contract.examination import Examination, Findings
from active_binocular_vision.examinations.contract.measure import Quartiles, key, measure
from active_binocular_vision.examinations.contract.trial_frame import behind
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.session import (
    Course,
    Session,
    check_has_lenses,
    check_shows_pictures,
    is_fused,
    session_of,
)
from active_binocular_vision.learners.shown import Shown
from lockstep import SIDES
from lockstep.machine.progress_lines import progress

_N_PICTURES = 3
_SETTLING_ITERATIONS = 20
_ITERATIONS_PER_STEP = 10
_SHARP_D = 0.5
CONVERGENCE = "convergence"
# What is covered in each test of accommodation.
_COVERED = {
    "accommodation": "",
    "accommodation, left eye": "right",
    "accommodation, right eye": "left",
}
TESTS = (CONVERGENCE, *_COVERED)
# Convergence: cut-off of 175 adults with normal binocular vision (Scheiman et al. 2003, Optom. Vis.
# Sci. 80, 214-225). Accommodation: the mean amplitude at the age of 20, 12.5 D (Hofstetter 1950).
_HUMAN_CM = {CONVERGENCE: "5 / 7", **dict.fromkeys(_COVERED, "8 / -")}


@dataclass(frozen=True, kw_only=True)
class NearPointRow:
    """One test over pictures.

    Null where it did not fail, or at once; n_failed: pictures with which it failed.
    """

    test: str = key("near point of")
    near_point_cm: Quartiles = measure("cm", "near point", 1, spread=True)
    near_point_d: Quartiles = measure("D", "near point", 2)
    recovery_cm: Quartiles = measure("cm", "recovery", 1)
    n_failed: int = measure("", "failed", 0)
    human_cm: str = measure("cm", "human near point / recovery")


@dataclass(frozen=True, kw_only=True)
class NearPointSummary:
    """Medians over pictures."""

    convergence_cm: float | None = measure("cm", "convergence", 1)
    accommodation_cm: float | None = measure("cm", "accommodation", 1)


@dataclass(frozen=True)
class NearPoint:
    """Of one picture, in D: infinite where nothing failed, below 0 without limit at once."""

    near_point_d: float
    recovery_d: float


def near_point(session: Session, i_picture: int, test: str, options: NearPointOptions) -> NearPoint:
    """Bring the plane nearer until the test fails for good, and away until it succeeds."""
    covered = _COVERED.get(test, "")
    eyes = session.eyes(i_picture, 1.0 / options.first_d)
    eyes.look(_SETTLING_ITERATIONS, covered=covered)

    def place_d(i_step: int) -> float:
        return options.first_d + i_step * options.step_d

    n_steps = math.floor((options.nearest_d - options.first_d) / options.step_d + 1e-9)
    while n_steps > 0 and not session.shows(1.0 / place_d(n_steps)):
        n_steps -= 1

    def succeeds(i_step: int) -> bool:
        nonlocal eyes
        distance_m = 1.0 / place_d(i_step)
        eyes = eyes.before(distance_m)
        course = eyes.look(_ITERATIONS_PER_STEP, covered=covered)
        if test == CONVERGENCE:
            return bool(is_fused(course.seen_deg[-1], session.px_deg))
        return _is_sharp(course, distance_m, covered)

    i_break, i_recovery = climb(succeeds, n_steps)
    if i_break is None:
        return NearPoint(math.inf, math.inf)
    return NearPoint(
        place_d(i_break - 1) if i_break else -math.inf,
        -math.inf if i_recovery is None else place_d(i_recovery),
    )


def _is_sharp(course: Course, distance_m: float, covered: str) -> bool:
    errors_d = np.abs(course.lens_state.error_d(distance_m))
    seeing = [side != covered for side in SIDES]
    return bool(errors_d[seeing].min() <= _SHARP_D)


def _examine(learners: FrozenLearners, shown: Shown, options: NearPointOptions) -> Findings:
    """Make each test before each picture."""
    check_has_lenses(learners, "--near-point")
    check_shows_pictures(shown, "--near-point")
    found: dict[str, list[NearPoint]] = {}
    with session_of(behind(learners, options, "--near-point"), shown, _N_PICTURES) as session:
        for test in progress(TESTS, file=sys.stderr, unit="test"):
            found[test] = [near_point(session, i, test, options) for i in range(session.n_pictures)]
    rows = [_row(test, of) for test, of in found.items()]
    convergence, accommodation = (row.near_point_cm.median for row in rows[:2])
    return Findings(
        n_stimuli=session.n_pictures,
        summary=NearPointSummary(convergence_cm=convergence, accommodation_cm=accommodation),
        tables={"tests": rows},
        titles={"tests": ""},
    )


def _row(test: str, found: Sequence[NearPoint]) -> NearPointRow:
    near_d, recovery_d = zip(*((of.near_point_d, of.recovery_d) for of in found), strict=True)
    return NearPointRow(
        test=test,
        near_point_cm=_cm(Quartiles.of_censored(near_d)),
        near_point_d=Quartiles.of_censored(near_d),
        recovery_cm=_cm(Quartiles.of_censored(recovery_d)),
        n_failed=int((np.array(near_d) < math.inf).sum()),
        human_cm=_HUMAN_CM[test],
    )


def _cm(quartiles_d: Quartiles) -> Quartiles:
    """Return quartiles of distances; the lower one is the nearest."""
    return Quartiles(*(None if d is None else 100.0 / d for d in reversed(quartiles_d)))


NEAR_POINT = Examination(
    declared=DECLARED["near-point"],
    examine=_examine,
    summary=NearPointSummary,
)
