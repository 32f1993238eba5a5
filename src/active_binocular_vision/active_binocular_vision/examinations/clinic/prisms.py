"""Fusion with prisms: the right eye's picture is turned more and more until the eyes lose it.

A prism of growing power is held before the right eye. Break is the first power at which fusion is
lost for good, recovery the first one on the way back at which it is regained.
"""

import math
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.examinations.contract.declared import DECLARED, PrismOptions
from active_binocular_vision.examinations.contract.examination import Examination, Findings
from active_binocular_vision.examinations.contract.measure import Quartiles, key, measure
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.session import Prism, Session, is_fused, session_of
from active_binocular_vision.learners.shown import Shown
from lockstep.machine.progress_lines import progress

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

    def n_steps(self, ladder_share: float = 1.0) -> int:
        """Return how many prisms there are, each stronger than the one before by a step."""
        return max(1, round(ladder_share * self.most_deg / self.step_deg))

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


def prism_trial(
    session: Session,
    i_picture: int,
    distance_m: float,
    direction: Direction,
    ladder_share: float = 1.0,
) -> PrismTrial:
    """Raise the prism until fusion is lost for good, then lower it until it is regained.

    ladder_share: how much of the steps up to the strongest prism of the direction there is.
    """
    eyes = session.eyes(i_picture, distance_m)
    without_deg = eyes.look(_SETTLING_ITERATIONS).eyes_deg[-1]
    steps: list[tuple[float, float, float, bool]] = []

    def try_step(i_step: int) -> bool:
        demand_deg = i_step * direction.step_deg
        course = eyes.look(_ITERATIONS_PER_STEP, prism=direction.prism(demand_deg))
        response_deg = direction.response_deg(course.eyes_deg[-1], without_deg)
        fused = bool(is_fused(course.seen_deg[-1], session.px_deg))
        if direction.i_error == _TORSIONAL:
            fused &= response_deg >= _LEAST_FOLLOWED * demand_deg or demand_deg == 0.0
        steps.append((demand_deg, response_deg, direction.lag_deg(course.seen_deg[-1]), fused))
        return fused

    climb(try_step, direction.n_steps(ladder_share))
    return PrismTrial(*(np.array(column) for column in zip(*steps, strict=True)))


def climb(try_step: Callable[[int], bool], n_steps: int) -> tuple[int | None, int | None]:
    """Try steps 0 to n_steps until _N_LOST of them fail in a row, then back until one succeeds.

    Return the first one of those that failed, and the one that succeeded; None where there is none.
    """
    n_lost = 0
    for i_step in range(n_steps + 1):
        n_lost = 0 if try_step(i_step) else n_lost + 1
        if n_lost == _N_LOST:
            back = range(i_step - 1, -1, -1)
            return i_step + 1 - _N_LOST, next((i for i in back if try_step(i)), None)
    return None, None


@dataclass(frozen=True, kw_only=True)
class PrismRow:
    """Prisms of one direction at one distance, over pictures.

    Break and recovery are null beyond the strongest prism, most_deg. n_broken, n_recovered: how
    many pictures fusion was lost and regained with.
    """

    direction: str = key("direction")
    object_distance_m: float = key("distance", "m")
    gain: Quartiles = measure("", "gain", 2)
    most_deg: float = measure("deg", "strongest", 1)
    break_deg: Quartiles = measure("deg", "break", 2)
    recovery_deg: Quartiles = measure("deg", "recovery", 2)
    break_pd: Quartiles = measure("PD", "break", 1)
    recovery_pd: Quartiles = measure("PD", "recovery", 1)
    n_broken: int = measure("", "broken", 0, is_shown=False)
    n_recovered: int = measure("", "recovered", 0, is_shown=False)
    human_pd: str = measure("PD", "human break / recovery")


_NAMES = tuple(direction.name for direction in DIRECTIONS)
_COLUMNS = tuple(name.replace(" ", "_") for name in _NAMES)


@dataclass(frozen=True, kw_only=True)
class PrismSummary:
    """Medians over pictures and distances by direction."""

    gain: Sequence[float | None] = measure(
        "", "gain", 2, columns=tuple(f"gain_{c}" for c in _COLUMNS), labels=_NAMES
    )
    break_deg: Sequence[float | None] = measure(
        "deg", "break", 2, columns=tuple(f"break_{c}_deg" for c in _COLUMNS), labels=_NAMES
    )


@dataclass(frozen=True)
class PrismTraces:
    """Trials by name of the direction and distance, one for each picture."""

    px_deg: float
    distances_m: tuple[float, ...]
    trials: dict[tuple[str, float], list[PrismTrial]]


def _examine(learners: FrozenLearners, shown: Shown, options: PrismOptions) -> Findings:
    """Try prisms in each direction at each distance before each picture."""
    trials: dict[tuple[str, float], list[PrismTrial]] = {}
    with session_of(learners, shown, _N_PICTURES) as session:
        conditions = [(d, distance_m) for d in DIRECTIONS for distance_m in options.distances_m]
        for direction, distance_m in progress(
            conditions, file=sys.stderr, desc="prisms", unit="part"
        ):
            trials[direction.name, distance_m] = [
                prism_trial(session, i, distance_m, direction, options.ladder_share)
                for i in range(session.n_pictures)
            ]
    return Findings(
        n_stimuli=session.n_pictures,
        summary=_summary(trials),
        tables={
            "conditions": [
                _row(d, m, trials[d.name, m], options.ladder_share) for d, m in conditions
            ]
        },
        titles={"conditions": ""},
        traces=PrismTraces(session.px_deg, options.distances_m, trials),
    )


def _row(
    direction: Direction, distance_m: float, trials: Sequence[PrismTrial], ladder_share: float
) -> PrismRow:
    breaks_deg = [trial.break_deg for trial in trials]
    recoveries_deg = [trial.recovery_deg for trial in trials]
    break_deg, recovery_deg = map(Quartiles.of_censored, (breaks_deg, recoveries_deg))
    return PrismRow(
        direction=direction.name,
        object_distance_m=distance_m,
        gain=Quartiles.of([trial.gain for trial in trials]),
        most_deg=direction.n_steps(ladder_share) * direction.step_deg,
        break_deg=break_deg,
        recovery_deg=recovery_deg,
        break_pd=break_deg.prism_dioptres,
        recovery_pd=recovery_deg.prism_dioptres,
        n_broken=int(np.isfinite(breaks_deg).sum()),
        n_recovered=int(np.isfinite(recoveries_deg).sum()),
        human_pd=HUMAN_PRISM_DIOPTRES.get((direction.name, distance_m), ""),
    )


def _summary(trials: dict[tuple[str, float], list[PrismTrial]]) -> PrismSummary:
    by_name = {
        name: [trial for (of, _), some in trials.items() if of == name for trial in some]
        for name in _NAMES
    }
    return PrismSummary(
        gain=[Quartiles.of([t.gain for t in of]).median for of in by_name.values()],
        break_deg=[
            Quartiles.of_censored([t.break_deg for t in of]).median for of in by_name.values()
        ],
    )


PRISMS = Examination(
    declared=DECLARED["prisms"],
    examine=_examine,
    summary=PrismSummary,
)
