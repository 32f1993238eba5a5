"""The cover test: one eye is covered and uncovered again, and what both eyes do is measured.

Directions are those of the clinic: eso (turned in), hyper (higher) and incyclo (upper pole turned
in) are above 0, of the eye that is covered.
"""

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.examinations.contract.declared import DECLARED, CoverOptions
from active_binocular_vision.examinations.contract.examination import Examination, Findings
from active_binocular_vision.examinations.contract.measure import (
    SHARE,
    Quartiles,
    key,
    measure,
    prism_dioptres,
)
from active_binocular_vision.examinations.contract.trial_frame import behind
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.session import Course, Session, is_fused, session_of
from active_binocular_vision.learners.shown import Shown
from lockstep import SIDES
from lockstep.machine.progress_lines import progress

Array = NDArray[np.float64]

AXES = ("horizontal", "vertical", "cyclo")
_N_PICTURES = 5
# Of each of the three parts: both eyes open, one covered, both open again.
_N_ITERATIONS = 20
_OPTIONS = CoverOptions()
# Expected findings of Morgan 1944, as in Scheiman & Wick (see prisms.py); near is 40 cm.
NOTES = "Human phoria, mean and SD: -1 and 2 PD far, -3 and 5 PD near (Morgan 1944)."


@dataclass(frozen=True, kw_only=True)
class CoverRow:
    """One covered eye at one distance, over pictures."""

    covered: str = key("covered")
    object_distance_m: float = key("distance", "m")
    tropia_horizontal_deg: Quartiles = measure("deg", "tropia")
    tropia_vertical_deg: Quartiles = measure("deg", "tropia vertical", is_shown=False)
    tropia_cyclo_deg: Quartiles = measure("deg", "tropia cyclo", is_shown=False)
    phoria_horizontal_deg: Quartiles = measure("deg", "phoria", 2, spread=True)
    phoria_horizontal_pd: Quartiles = measure("PD", "phoria", 1)
    phoria_vertical_deg: Quartiles = measure("deg", "vertical", 2)
    phoria_vertical_pd: Quartiles = measure("PD", "vertical", 1, is_shown=False)
    phoria_cyclo_deg: Quartiles = measure("deg", "cyclo", 2)
    iterations_until_fused: Quartiles = measure("", "fused after", 0)
    share_fused: float = measure(SHARE, "fused")
    left_moves_deg: Quartiles = measure("deg", "left moves", 2)
    right_moves_deg: Quartiles = measure("deg", "right moves", 2)


@dataclass(frozen=True, kw_only=True)
class CoverSummary:
    """Over pictures and distances: deviation of the covered right eye, and covers of both eyes."""

    horizontal_deviation_pd: float | None = measure("PD", "horizontal deviation", 1)
    vertical_deviation_pd: float | None = measure("PD", "vertical deviation", 1)
    share_fused: float = measure(SHARE, "fused")


@dataclass(frozen=True)
class CoverTrial:
    """One eye covered before one picture.

    deviation_deg: (n + 1, 3) of the covered eye, eso, hyper and incyclo positive; begin, end: the
    iterations at which the cover is put on and taken off; moved_deg: (2,) how far the line of sight
    of the left and the right eye turns between the end of the cover and the end.
    """

    deviation_deg: Array
    begin: int
    end: int
    moved_deg: Array

    @property
    def tropia_deg(self) -> Array:
        """Deviation (3,) with both eyes open, before the cover."""
        return np.asarray(self.deviation_deg[self.begin])

    @property
    def phoria_deg(self) -> Array:
        """Deviation (3,) at the end of the cover."""
        return np.asarray(self.deviation_deg[self.end])

    def fused_after(self, px_deg: float) -> float:
        """Return iterations without the cover until both errors are below one pixel and stay so.

        Infinite where they are not at the end.
        """
        return first_lasting(is_fused(self.deviation_deg[self.end :], px_deg))


@dataclass(frozen=True)
class CoverTraces:
    """Trials by covered eye and distance, one for each picture; px_deg: visual angle of a pixel."""

    px_deg: float
    distances_m: tuple[float, ...]
    trials: dict[tuple[str, float], list[CoverTrial]]


def first_lasting(holds: NDArray[np.bool_]) -> float:
    """Return the first index from which on a condition (n,) always holds, infinite for none."""
    broken = np.flatnonzero(~holds)
    first = int(broken[-1]) + 1 if len(broken) else 0
    return float(first) if first < len(holds) else math.inf


def cover_trial(
    session: Session,
    i_picture: int,
    distance_m: float,
    covered: str,
    options: CoverOptions = _OPTIONS,
) -> CoverTrial:
    """Make the test before one picture; covered: the side of the eye.

    The eyes begin without errors, at rest or as they were left.
    """
    begin_with = session.eyes_at_rest if options.at_rest else session.eyes
    if options.at_habit:
        begin_with = session.eyes_as_left
    eyes = begin_with(i_picture, distance_m)
    other = SIDES[1 - SIDES.index(covered)]
    sides = ("", other, covered, "") if options.alternate else ("", covered, "")
    parts = [eyes.look(_N_ITERATIONS, covered=side) for side in sides]
    begin, end = np.cumsum([part.n_iterations for part in parts[:-1]])[-2:].tolist()
    # Each part begins where the one before ends.
    deviations = [deviation_of(part, covered) for part in parts]
    deviation_deg = np.concatenate([*(d[:-1] for d in deviations), deviations[-1][-1:]])
    return CoverTrial(deviation_deg, begin, end, turned_deg(parts[-1]))


def deviation_of(course: Course, side: str) -> Array:
    """Return the deviation (n + 1, 3) of one eye from where the other one looks."""
    # GazeError is above 0 where eyes converge too little, and where the left eye is higher.
    higher = 1.0 if side == "left" else -1.0
    deviation: Array = course.seen_deg * np.array([-1.0, higher, 1.0])
    return deviation


def turned_deg(course: Course) -> Array:
    """Return the angle (2,) between each eye's first and last line of sight."""
    first, last = course.lines_of_sight[[0, -1]]
    across = np.linalg.norm(np.cross(first, last), axis=-1)
    return np.degrees(np.arctan2(across, (first * last).sum(axis=-1)))


def _examine(learners: FrozenLearners, shown: Shown, options: CoverOptions) -> Findings:
    """Make the cover test of each eye at each distance before each picture."""
    trials: dict[tuple[str, float], list[CoverTrial]] = {}
    with session_of(behind(learners, options, "--cover"), shown, _N_PICTURES) as session:
        conditions = [(side, m) for side in SIDES for m in options.distances_m]
        for side, distance_m in progress(conditions, file=sys.stderr, desc="cover", unit="part"):
            trials[side, distance_m] = [
                cover_trial(session, i, distance_m, side, options)
                for i in range(session.n_pictures)
            ]
    px_deg = session.px_deg
    return Findings(
        n_stimuli=session.n_pictures,
        summary=_summary(trials, px_deg),
        tables={"conditions": [_row(*of, px_deg) for of in trials.items()]},
        titles={"conditions": ""},
        notes=NOTES,
        traces=CoverTraces(px_deg, options.distances_m, trials),
    )


def _row(condition: tuple[str, float], trials: Sequence[CoverTrial], px_deg: float) -> CoverRow:
    """Return the measures of one eye at one distance."""
    side, distance_m = condition
    fused_after = [trial.fused_after(px_deg) for trial in trials]
    tropia, phoria, moved = (
        [Quartiles.of(values) for values in np.array(of_trials).T]
        for of_trials in zip(
            *((t.tropia_deg, t.phoria_deg, t.moved_deg) for t in trials), strict=True
        )
    )
    return CoverRow(
        covered=side,
        object_distance_m=distance_m,
        **{f"tropia_{axis}_deg": of for axis, of in zip(AXES, tropia, strict=True)},
        **{f"phoria_{axis}_deg": of for axis, of in zip(AXES, phoria, strict=True)},
        phoria_horizontal_pd=phoria[0].prism_dioptres,
        phoria_vertical_pd=phoria[1].prism_dioptres,
        iterations_until_fused=Quartiles.of_censored(fused_after),
        share_fused=float(np.isfinite(fused_after).mean()),
        left_moves_deg=moved[0],
        right_moves_deg=moved[1],
    )


def _summary(trials: dict[tuple[str, float], list[CoverTrial]], px_deg: float) -> CoverSummary:
    phoria_deg = [
        trial.phoria_deg for (side, _), of in trials.items() if side == SIDES[1] for trial in of
    ]
    horizontal_deg, vertical_deg, _ = np.median(phoria_deg, axis=0).tolist()
    fused_after = [trial.fused_after(px_deg) for of in trials.values() for trial in of]
    return CoverSummary(
        horizontal_deviation_pd=prism_dioptres(horizontal_deg),
        vertical_deviation_pd=prism_dioptres(vertical_deg),
        share_fused=float(np.isfinite(fused_after).mean()),
    )


COVER = Examination(
    declared=DECLARED["cover"],
    examine=_examine,
    summary=CoverSummary,
)
