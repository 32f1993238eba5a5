"""Fusion with prisms: the right eye's picture is turned more and more until the eyes lose it.

A prism of growing power is held before the right eye. Break is the first power at which fusion is
lost for good, recovery the first one on the way back at which it is regained.
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
from active_binocular_vision.examinations.room import Prism, Room, examination_room, is_fused
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.shown import OWN_TEST_STIMULI, Shown
from experiment_manager.measures.tables import number, text_table
from experiment_manager.terminal.progress_lines import progress

Array = NDArray[np.float64]

NEAR_M, FAR_M = DISTANCES_M = (0.5, 6.0)
_N_PICTURES = 3
_SETTLING_ITERATIONS = 20
_ITERATIONS_PER_STEP = 10
# Fusion is lost for good if it is lost in so many steps one after the other.
_N_LOST = 3
# Cyclovergence has followed if it made up for this share of the demand.
_LEAST_FOLLOWED = 0.5
_TORSIONAL = 2


@dataclass(frozen=True)
class Direction:
    """A way to turn the right eye's picture.

    name: base of the prism, or what the eyes must do about the line of sight; setting: of Prism;
    sign: of that setting; i_error: the error of the eyes that changes, with a sign of its own where
    the eyes follow; step_deg, most_deg: of the demand.
    """

    name: str
    setting: str
    sign: float
    i_error: int
    error_sign: float
    step_deg: float
    most_deg: float

    def prism(self, demand_deg: float) -> Prism:
        """Return the prism that asks for so much."""
        return Prism(**{self.setting: self.sign * demand_deg})

    def response_deg(self, eyes_deg: Array, without_deg: Array) -> float:
        """Return how far eyes with errors (3,) have followed, from their errors without a prism."""
        return float(self.error_sign * (eyes_deg - without_deg)[self.i_error])

    def lag_deg(self, seen_deg: Array) -> float:
        """Return how far eyes whose pictures have errors (3,) are behind what the prism asks."""
        return float(-self.error_sign * seen_deg[self.i_error])


# A camera that is turned toward the nose by an angle asks for an error of that angle: the eyes
# diverge, as with the base in. The right eye behind a prism with the base up turns down.
DIRECTIONS = (
    Direction("base out", "rotation_deg", -1.0, 0, -1.0, 0.5, 25.0),
    Direction("base in", "rotation_deg", 1.0, 0, 1.0, 0.5, 25.0),
    Direction("base up", "elevation_deg", 1.0, 1, 1.0, 0.25, 10.0),
    Direction("base down", "elevation_deg", -1.0, 1, -1.0, 0.25, 10.0),
    Direction("incyclo", "roll_deg", -1.0, _TORSIONAL, 1.0, 0.5, 15.0),
    Direction("excyclo", "roll_deg", 1.0, _TORSIONAL, -1.0, 0.5, 15.0),
)

# Break and recovery in prism dioptres. Horizontal: Morgan's table of expected findings (Morgan
# 1944), as Scheiman & Wick, Clinical Management of Binocular Vision, table 2.2, print it; near is
# 40 cm there. Vertical: the limits of most subjects (Ogle & Prangen 1953, AMA Arch. Ophthalmol. 49,
# 313-334), who give no recovery and no distance.
HUMAN_PRISM_DIOPTRES = {
    ("base out", FAR_M): "19 / 10",
    ("base in", FAR_M): "7 / 4",
    ("base out", NEAR_M): "21 / 11",
    ("base in", NEAR_M): "21 / 13",
    **{(f"base {way}", m): "2.5 to 3 / -" for way in ("up", "down") for m in DISTANCES_M},
}


@dataclass(frozen=True)
class PrismTrial:
    """One picture, prisms of growing and falling power in one direction.

    Arrays are (n,), of each step in the order in which they were made, the first one without a
    prism. demand_deg: what the prism asks for; response_deg: how far the eyes have followed at the
    end of the step; lag_deg: the disparity that is left then, the fixation disparity; fused:
    whether they fuse then.
    """

    demand_deg: Array
    response_deg: Array
    lag_deg: Array
    fused: NDArray[np.bool_]

    @property
    def i_turn(self) -> int:
        """Number of the step with the strongest prism."""
        return int(np.argmax(self.demand_deg))

    @property
    def i_break(self) -> int | None:
        """Number of the first step at which fusion is lost for good; None if it never is."""
        is_lost = not self.fused[max(0, self.i_turn + 1 - _N_LOST) : self.i_turn + 1].any()
        return self.i_turn + 1 - _N_LOST if is_lost and self.i_turn + 1 >= _N_LOST else None

    @property
    def i_recovery(self) -> int | None:
        """Number of the first step on the way back at which fusion is regained, None for none."""
        back = np.flatnonzero(self.fused & (np.arange(len(self.fused)) > self.i_turn))
        return int(back[0]) if len(back) else None

    @property
    def break_deg(self) -> float:
        """Demand of the break; infinite: fusion was not lost up to the strongest prism."""
        return math.inf if self.i_break is None else float(self.demand_deg[self.i_break])

    @property
    def recovery_deg(self) -> float:
        """Demand of the recovery.

        Infinite: fusion was not lost; below 0 without limit: it was not regained without a prism.
        """
        if self.i_recovery is not None:
            return float(self.demand_deg[self.i_recovery])
        return math.inf if self.i_break is None else -math.inf

    @property
    def gain(self) -> float:
        """Slope of the response over a growing demand: least squares through 0."""
        demand_deg, response_deg = (
            values[: self.i_turn + 1] for values in (self.demand_deg, self.response_deg)
        )
        return float((demand_deg * response_deg).sum() / (demand_deg**2).sum())


def prism_trial(room: Room, i_picture: int, distance_m: float, direction: Direction) -> PrismTrial:
    """Raise the prism until fusion is lost for good, then lower it until it is regained."""
    sitting = room.seat(i_picture, distance_m)
    without_deg = sitting.look(_SETTLING_ITERATIONS).eyes_deg[-1]
    steps: list[tuple[float, float, float, bool]] = []

    def try_step(i_step: int) -> bool:
        demand_deg = i_step * direction.step_deg
        course = sitting.look(_ITERATIONS_PER_STEP, prism=direction.prism(demand_deg))
        response_deg = direction.response_deg(course.eyes_deg[-1], without_deg)
        fused = bool(is_fused(course.seen_deg[-1], room.px_deg))
        if direction.i_error == _TORSIONAL:
            fused &= response_deg >= _LEAST_FOLLOWED * demand_deg or demand_deg == 0.0
        steps.append((demand_deg, response_deg, direction.lag_deg(course.seen_deg[-1]), fused))
        return fused

    n_lost = 0
    for i_step in range(round(direction.most_deg / direction.step_deg) + 1):
        n_lost = 0 if try_step(i_step) else n_lost + 1
        if n_lost == _N_LOST:
            break
    if n_lost == _N_LOST:
        for i_back in range(i_step - 1, -1, -1):
            if try_step(i_back):
                break
    return PrismTrial(*(np.array(column) for column in zip(*steps, strict=True)))


@dataclass(frozen=True)
class PrismResults:
    """What frozen learners did with prisms.

    stimuli: what was shown, in words, "" for the run's own; trials: by name of the direction and
    distance, one for each picture.
    """

    learners: FrozenLearners
    stimuli: str
    px_deg: float
    trials: dict[tuple[str, float], list[PrismTrial]]

    def to_json(self) -> dict[str, Any]:
        """Return what evaluate.sh writes."""
        most_deg = {direction.name: direction.most_deg for direction in DIRECTIONS}
        return self.learners.said() | {
            "examination": "prisms",
            "stimuli": self.stimuli,
            "n_stimuli": len(next(iter(self.trials.values()))),
            "pixel_deg": self.px_deg,
            "conditions": [
                {"direction": name, "object_distance_m": distance_m, "most_deg": most_deg[name]}
                | _condition(trials)
                | {"human_prism_dioptres": HUMAN_PRISM_DIOPTRES.get((name, distance_m))}
                for (name, distance_m), trials in self.trials.items()
            ],
        }

    def table(self) -> str:
        """Return the medians as text."""
        header = (
            "direction",
            "distance/m",
            "gain",
            "break/deg",
            "recovery/deg",
            "break/recovery PD",
        )
        rows = [_row(condition) for condition in self.to_json()["conditions"]]
        return text_table((*header, "human PD"), rows)


def examine(learners: FrozenLearners, shown: Shown = OWN_TEST_STIMULI) -> PrismResults:
    """Try prisms in each direction at each distance before each picture.

    Raises InputError as the cover test does.
    """
    trials: dict[tuple[str, float], list[PrismTrial]] = {}
    with examination_room(learners, shown, _N_PICTURES) as room:
        conditions = [(d, distance_m) for d in DIRECTIONS for distance_m in DISTANCES_M]
        for direction, distance_m in progress(
            conditions, file=sys.stderr, desc="prisms", unit="part"
        ):
            trials[direction.name, distance_m] = [
                prism_trial(room, i, distance_m, direction) for i in range(room.n_pictures)
            ]
        return PrismResults(learners, shown.text, room.px_deg, trials)


def _condition(trials: Sequence[PrismTrial]) -> dict[str, Any]:
    breaks_deg = [trial.break_deg for trial in trials]
    recoveries_deg = [trial.recovery_deg for trial in trials]
    break_deg, recovery_deg = map(censored_quartiles_of, (breaks_deg, recoveries_deg))
    return {
        "break_deg": break_deg,
        "recovery_deg": recovery_deg,
        "break_prism_dioptres": in_prism_dioptres(break_deg),
        "recovery_prism_dioptres": in_prism_dioptres(recovery_deg),
        "gain": quartiles_of([trial.gain for trial in trials]),
        "n_broken": int(np.isfinite(breaks_deg).sum()),
        "n_recovered": int(np.isfinite(recoveries_deg).sum()),
    }


def _row(condition: dict[str, Any]) -> tuple[str, ...]:
    break_deg = condition["break_deg"]["median"]
    lost_at = f"> {condition['most_deg']:g}" if break_deg is None else number(break_deg, 2)
    break_pd, recovery_pd = (
        number(condition[f"{name}_prism_dioptres"]["median"], 1) for name in ("break", "recovery")
    )
    return (
        condition["direction"],
        f"{condition['object_distance_m']:g}",
        number(condition["gain"]["median"], 2),
        lost_at,
        number(condition["recovery_deg"]["median"], 2),
        f"{break_pd} / {recovery_pd}" if condition["direction"].startswith("base") else "",
        condition["human_prism_dioptres"] or "",
    )
