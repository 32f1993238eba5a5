"""C*: the least metabolic rate with which the commanded muscles hold correct vergence (K17)."""

import math
from functools import lru_cache

import numpy as np

from eye_plant.inverse.gaze import ERRORS, TURNED_ANGLES, GazeInverse, LeastCost
from eye_plant.inverse.pair import Inverse, Limits, pair_limits
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from eye_plant.turns import NO_TURNS_DEG, TurnsDeg
from eye_plant.vergence import fixation_distance_m
from lockstep import COMMAND_SPACES, PAIR, InputError

# Vergences from 10 m to 0.3 m with the eyes of K17; in between the rate is nearly straight.
_VERGENCES_DEG = np.linspace(0.32, 10.72, 27)


class PairCost:
    """The least rate of both eyes alike, by the line of pairs that give the vergence."""

    def __init__(self, mechanics: MechanicsConfig, limits: Limits) -> None:
        """limits: ((lowest, highest) medial, (lowest, highest) lateral)."""
        self._inverse, self._limits = Inverse(mechanics), limits

    def least_w(self, vergence_deg: float) -> float:
        """Return the least metabolic rate with a vergence; InputError where no pair gives it."""
        return self._inverse.optimal(vergence_deg, self._limits).metabolic_rate_w


class MuscleCost:
    """The least rate of muscles that have a command each.

    Held are the errors that the muscles can turn, horizontal, vertical and torsional; version is
    free. The eyes look at a plane straight ahead at the distance of the vergence.
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

    def least_w(self, vergence_deg: float) -> float:
        """Return the least metabolic rate with a vergence, between those of a table.

        Raises InputError for one that the muscles do not reach, or beyond the table.
        """
        check_tabled(vergence_deg)
        found = float(np.interp(vergence_deg, _VERGENCES_DEG, _least_rates_w(*self._table)))
        if not np.isfinite(found):
            raise InputError(
                f"no activations of these muscles give a vergence of {vergence_deg:g} deg"
            )
        return found


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


@lru_cache(maxsize=16)
def _least_rates_w(
    mechanics: MechanicsConfig, space: str, lowest: tuple[float, ...], turns_deg: TurnsDeg
) -> tuple[float, ...]:
    """Return the least rate at each of _VERGENCES_DEG, infinite where the muscles do not reach."""
    highest = np.ones(len(lowest))
    inverse = GazeInverse(mechanics, COMMAND_SPACES[space], lowest, highest, turns_deg)
    wanted_deg = {name: 0.0 for name in ERRORS if name in TURNED_ANGLES[space]}
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
