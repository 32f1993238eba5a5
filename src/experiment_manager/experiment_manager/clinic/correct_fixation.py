"""Activations with which eyes look correctly at a plane, or off by a chosen horizontal error."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from experiment_manager.experiment.config import ProtocolConfig
from eye_plant.inverse.gaze import TURNED_ANGLES, GazeInverse
from eye_plant.inverse.pair import Inverse
from eye_plant.mechanics.model import MechanicsConfig
from eye_plant.vergence import desired_vergence_deg
from lockstep.command_space import PAIR

Activations = tuple[float, ...]

# Where on the line of pairs of equal vergence the pair begins: half-way.
_FRACTION = 0.5


class CorrectFixation:
    """Activations for eyes of a run.

    A stereogram with parallax p on the plane is to eyes b apart what a plane is to eyes b + p
    apart, so one rule serves both. Each muscle that has a command of its own is as near to the
    tonic level as the gaze allows. Eyes that make saccades look with the left eye straight ahead,
    where their target is; others look straight ahead together.
    """

    def __init__(
        self, protocol: ProtocolConfig, mechanics: MechanicsConfig, parallax_m: float = 0.0
    ) -> None:
        """parallax_m: of a stereogram, as desired_vergence_deg takes it."""
        self._protocol = protocol
        self._baseline_m = mechanics.baseline_m + parallax_m
        self._find = self._finder(replace(mechanics, baseline_m=self._baseline_m))

    def activations(self, distance_m: float, error_deg: float = 0.0) -> Activations:
        """Return activations (12,) with a horizontal error before a plane, other errors 0.

        error_deg: above 0 where the eyes converge too little. Raises InputError for a gaze that the
        muscles do not reach.
        """
        return self._find(distance_m, error_deg)

    def _finder(self, mechanics: MechanicsConfig) -> Callable[[float, float], Activations]:
        protocol = self._protocol
        if protocol.command_space == PAIR:
            pair = Inverse(mechanics)

            def of_pair(distance_m: float, error_deg: float) -> Activations:
                vergence_deg = desired_vergence_deg(distance_m, self._baseline_m) - error_deg
                return pair.activations(vergence_deg, _FRACTION, protocol.pair_limits)

            return of_pair
        limits, space = protocol.limits, protocol.space
        inverse = GazeInverse(mechanics, space, limits.lowest, limits.highest)

        def of_muscles(distance_m: float, error_deg: float) -> Activations:
            wanted_deg = dict.fromkeys(TURNED_ANGLES[protocol.command_space], 0.0)
            wanted_deg["horizontal"] = error_deg
            if protocol.fixation_iterations:
                right_deg = math.degrees(math.atan(self._baseline_m / distance_m)) - error_deg
                wanted_deg["version"] = -right_deg / 2.0
            nowhere_aside = np.zeros(len(space.names))
            return tuple(inverse.activations(wanted_deg, distance_m, nowhere_aside).tolist())

        return of_muscles
