"""The cover test: one eye is covered and uncovered again, and what both eyes do is measured.

Directions are those of the clinic: eso (turned in), hyper (higher) and incyclo (upper pole turned
in) are above 0, of the eye that is covered.
"""

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.examinations.quartiles import (
    censored_quartiles_of,
    in_prism_dioptres,
    quartiles_of,
)
from active_binocular_vision.examinations.room import Course, Room, examination_room, is_fused
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.shown import OWN_TEST_STIMULI, Shown
from experiment_manager.measures.tables import number, percent, text_table
from experiment_manager.terminal.progress_lines import progress
from lockstep import SIDES

Array = NDArray[np.float64]

DISTANCES_M = (0.5, 2.0, 6.0)
AXES = ("horizontal", "vertical", "cyclo")
_N_PICTURES = 5
# Of each of the three parts: both eyes open, one covered, both open again.
_N_ITERATIONS = 20


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


def first_lasting(holds: NDArray[np.bool_]) -> float:
    """Return the first index from which on a condition (n,) always holds, infinite for none."""
    broken = np.flatnonzero(~holds)
    first = int(broken[-1]) + 1 if len(broken) else 0
    return float(first) if first < len(holds) else math.inf


def cover_trial(
    room: Room, i_picture: int, distance_m: float, covered: str, *, at_rest: bool = False
) -> CoverTrial:
    """Make the test before one picture; covered: the side of the eye.

    The eyes begin without errors, or at rest.
    """
    seat = room.seat_at_rest if at_rest else room.seat
    sitting = seat(i_picture, distance_m)
    parts = [sitting.look(_N_ITERATIONS, covered=side) for side in ("", covered, "")]
    begin, end = np.cumsum([part.n_iterations for part in parts[:2]]).tolist()
    course = parts[0].then(*parts[1:])
    return CoverTrial(deviation_of(course, covered), begin, end, turned_deg(parts[2]))


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


@dataclass(frozen=True)
class CoverResults:
    """What frozen learners did in the cover test.

    stimuli: what was shown, in words, "" for the run's own; trials: by covered eye and distance,
    one for each picture.
    """

    learners: FrozenLearners
    stimuli: str
    px_deg: float
    trials: dict[tuple[str, float], list[CoverTrial]]

    def to_json(self) -> dict[str, Any]:
        """Return what evaluate.sh writes."""
        return self.learners.said() | {
            "examination": "cover",
            "stimuli": self.stimuli,
            "n_stimuli": len(next(iter(self.trials.values()))),
            "pixel_deg": self.px_deg,
            "conditions": [
                {"covered": side, "object_distance_m": distance_m} | _condition(trials, self.px_deg)
                for (side, distance_m), trials in self.trials.items()
            ],
        }

    def table(self) -> str:
        """Return the medians as text."""
        header = ["covered", "distance/m", "tropia/deg", "phoria/deg", "quartiles", "PD"]
        header += ["vertical/deg", "cyclo/deg", "fused after", "fused", "left moves", "right moves"]
        rows = [_row(condition) for condition in self.to_json()["conditions"]]
        return text_table(header, rows)


def examine(
    learners: FrozenLearners,
    shown: Shown = OWN_TEST_STIMULI,
    distances_m: Sequence[float] = DISTANCES_M,
    *,
    at_rest: bool = False,
) -> CoverResults:
    """Make the cover test of each eye at each distance before each picture.

    at_rest: whether the eyes begin at rest, so that those that do not move show the deviation that
    they have anyway; otherwise they begin without errors. Raises InputError for learners or
    pictures that cannot be used, and eyes that cannot look at a plane correctly.
    """
    trials: dict[tuple[str, float], list[CoverTrial]] = {}
    with examination_room(learners, shown, _N_PICTURES) as room:
        conditions = [(side, distance_m) for side in SIDES for distance_m in distances_m]
        for side, distance_m in progress(conditions, file=sys.stderr, desc="cover", unit="part"):
            trials[side, distance_m] = [
                cover_trial(room, i, distance_m, side, at_rest=at_rest)
                for i in range(room.n_pictures)
            ]
        return CoverResults(learners, shown.text, room.px_deg, trials)


def _condition(trials: Sequence[CoverTrial], px_deg: float) -> dict[str, Any]:
    """Return the measures of one eye at one distance."""
    fused_after = [trial.fused_after(px_deg) for trial in trials]
    moved_deg = np.array([trial.moved_deg for trial in trials])
    return {
        "tropia_deg": _by_axis([trial.tropia_deg for trial in trials]),
        "phoria_deg": (phoria_deg := _by_axis([trial.phoria_deg for trial in trials])),
        "phoria_prism_dioptres": {axis: in_prism_dioptres(phoria_deg[axis]) for axis in AXES[:2]},
        "iterations_until_fused": censored_quartiles_of(fused_after),
        "share_fused": float(np.isfinite(fused_after).mean()),
        "moves_when_uncovered_deg": {
            side: quartiles_of(of_eye) for side, of_eye in zip(SIDES, moved_deg.T, strict=True)
        },
    }


def _by_axis(deviations_deg: Sequence[Array]) -> dict[str, dict[str, float | None]]:
    of_axes = np.array(deviations_deg).T
    return {axis: quartiles_of(values) for axis, values in zip(AXES, of_axes, strict=True)}


def _row(condition: dict[str, Any]) -> tuple[str, ...]:
    phoria_deg = condition["phoria_deg"]
    horizontal_deg = phoria_deg["horizontal"]
    low, high = (number(horizontal_deg[f"{name}_quartile"], 2) for name in ("lower", "upper"))
    moves = condition["moves_when_uncovered_deg"]
    return (
        condition["covered"],
        f"{condition['object_distance_m']:g}",
        number(condition["tropia_deg"]["horizontal"]["median"]),
        number(horizontal_deg["median"], 2),
        f"{low} to {high}",
        number(condition["phoria_prism_dioptres"]["horizontal"]["median"], 1),
        number(phoria_deg["vertical"]["median"], 2),
        number(phoria_deg["cyclo"]["median"], 2),
        number(condition["iterations_until_fused"]["median"], 0),
        percent(condition["share_fused"]),
        *(number(moves[side]["median"], 2) for side in SIDES),
    )
