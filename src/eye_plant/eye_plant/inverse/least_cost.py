"""C*: the least metabolic rate with which the commanded muscles hold correct gaze (K17)."""

import math
from functools import cached_property, lru_cache

import numpy as np

from eye_plant.inverse.gaze import ERRORS, LEFT_SIGHT, TURNED_ANGLES, GazeInverse, LeastCost
from eye_plant.inverse.pair import Inverse, Limits, pair_limits
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from eye_plant.turns import NO_TURNS_DEG, TurnsDeg
from eye_plant.vergence import fixation_distance_m
from lockstep import COMMAND_SPACES, PAIR, InputError

# Vergences from 10 m to 0.3 m with the eyes of K17; in between the rate is nearly straight.
_VERGENCES_DEG = np.linspace(0.32, 10.72, 27)
# With these and equal first weights. Of 150 random targets within 10 deg (anatomical eyes, seed 0)
# all twelve muscles in turn found less at one, by 2 %, and take four times as long.
DEAR = ("left_medial_rectus", "right_medial_rectus")
# Targets whose costs are kept: those of a whole test, which are the same in the next one.
_MOST_KEPT = 1 << 14

TargetDeg = tuple[float, float]


class PairCost:
    """The least rate of both eyes alike, by the line of pairs that give the vergence."""

    def __init__(self, mechanics: MechanicsConfig, limits: Limits) -> None:
        """limits: ((lowest, highest) medial, (lowest, highest) lateral)."""
        self._inverse, self._limits = Inverse(mechanics), limits

    def least_w(self, vergence_deg: float, target_deg: TargetDeg | None = None) -> float:
        """Return the least metabolic rate with a vergence; InputError where no pair gives it.

        target_deg: ignored, since a pair does not turn both eyes the same way.
        """
        return self._inverse.optimal(vergence_deg, self._limits).metabolic_rate_w


class MuscleCost:
    """The least rate of muscles that have a command each.

    Held are the errors that the muscles can turn, horizontal, vertical and torsional, and the left
    camera's line of sight where there is a target for it; what is not held is free. The eyes look
    at a plane straight ahead at the distance of the vergence.
    """

    def __init__(
        self,
        mechanics: MechanicsConfig,
        space: str,
        lowest: tuple[float, ...],
        turns_deg: TurnsDeg = NO_TURNS_DEG,
    ) -> None:
        """lowest: least activation of each muscle of the space; turns_deg: as GazeInverse's."""
        self._table = mechanics, space, lowest, turns_deg
        self._at_targets_w: dict[tuple[float, TargetDeg], float] = {}

    def least_w(self, vergence_deg: float, target_deg: TargetDeg | None = None) -> float:
        """Return the least metabolic rate with a vergence.

        target_deg: azimuth (right) and elevation from the left eye of what it looks at; NaN where
        the muscles do not reach that gaze. Without a target version is free, and the rate lies
        between those of a table; raises InputError for a vergence that the muscles do not reach,
        or beyond the table.
        """
        check_tabled(vergence_deg)
        if target_deg is not None:
            return self._least_at_w(vergence_deg, target_deg)
        found = float(np.interp(vergence_deg, _VERGENCES_DEG, _least_rates_w(*self._table)))
        if not np.isfinite(found):
            raise InputError(
                f"no activations of these muscles give a vergence of {vergence_deg:g} deg"
            )
        return found

    def _least_at_w(self, vergence_deg: float, target_deg: TargetDeg) -> float:
        place, known = (vergence_deg, target_deg), self._at_targets_w
        if place not in known:
            mechanics, space, *_ = self._table
            wanted_deg = _fused_deg(space) | dict(zip(LEFT_SIGHT, target_deg, strict=True))
            distance_m = fixation_distance_m(vergence_deg, mechanics.baseline_m)
            try:
                rate_w = self._inverse.least(wanted_deg, distance_m, dear=DEAR).metabolic_rate_w
            except InputError:
                rate_w = math.nan
            if len(known) >= _MOST_KEPT:
                known.clear()
            known[place] = rate_w if math.isfinite(rate_w) else math.nan
        return known[place]

    @cached_property
    def _inverse(self) -> GazeInverse:
        return _inverse_of(*self._table)


CostOfVergence = PairCost | MuscleCost


def check_tabled(vergence_deg: float) -> None:
    """Raise InputError unless a vergence is among those of which the least costs are tabled."""
    least_deg, most_deg = _VERGENCES_DEG[[0, -1]]
    if not least_deg <= vergence_deg <= most_deg:
        raise InputError(
            f"with a command for each muscle: expected planes at which eyes converge by "
            f"{least_deg:g} to {most_deg:g} deg, got {vergence_deg:.2f} deg"
        )


def cost_of_vergence(
    mechanics: MechanicsConfig,
    space: str,
    lowest: tuple[float, ...],
    turns_deg: TurnsDeg = NO_TURNS_DEG,
) -> CostOfVergence:
    """Return the least costs of eyes with a command space and its least activations.

    turns_deg: of the cameras; the pair's errors are those of the eyes themselves.
    """
    if space == PAIR:
        return PairCost(mechanics, pair_limits(lowest, (1.0, 1.0)))
    return MuscleCost(mechanics, space, lowest, turns_deg)


def _fused_deg(space: str) -> dict[str, float]:
    return {name: 0.0 for name in ERRORS if name in TURNED_ANGLES[space]}


def _inverse_of(
    mechanics: MechanicsConfig, space: str, lowest: tuple[float, ...], turns_deg: TurnsDeg
) -> GazeInverse:
    return GazeInverse(mechanics, COMMAND_SPACES[space], lowest, np.ones(len(lowest)), turns_deg)


@lru_cache(maxsize=16)
def _least_rates_w(
    mechanics: MechanicsConfig, space: str, lowest: tuple[float, ...], turns_deg: TurnsDeg
) -> tuple[float, ...]:
    """Return the least rate at each of _VERGENCES_DEG, infinite where the muscles do not reach."""
    inverse, wanted_deg = _inverse_of(mechanics, space, lowest, turns_deg), _fused_deg(space)
    rates_w: list[float] = []
    near: LeastCost | None = None
    for vergence_deg in _VERGENCES_DEG:
        distance_m = fixation_distance_m(float(vergence_deg), mechanics.baseline_m)
        try:
            near = inverse.least(wanted_deg, distance_m, near)
        except InputError:
            rates_w.append(math.inf)
        else:
            rates_w.append(near.metabolic_rate_w)
    return tuple(rates_w)
