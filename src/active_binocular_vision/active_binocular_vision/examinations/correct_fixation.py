"""Activations with which eyes look correctly at a plane, or off by a chosen horizontal error."""

import math
from dataclasses import replace

import numpy as np

from experiment_manager.experiment.config import ProtocolConfig
from experiment_manager.experiment.starts import Activations, gaze_inverse
from eye_plant import Inverse, desired_vergence_deg
from eye_plant.inverse.gaze import TURNED_ANGLES
from eye_plant.mechanics.model import MechanicsConfig
from eye_plant.turns import NO_TURNS_DEG, TurnsDeg
from lockstep import PAIR

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
        self,
        protocol: ProtocolConfig,
        mechanics: MechanicsConfig,
        turns_deg: TurnsDeg = NO_TURNS_DEG,
        parallax_m: float = 0.0,
    ) -> None:
        """turns_deg: of the cameras, which do not count for the pair.

        parallax_m: of a stereogram, as desired_vergence_deg takes it.
        """
        self._protocol = protocol
        self._baseline_m = mechanics.baseline_m + parallax_m
        self._inward_deg = [turn[0] for turn in turns_deg]
        eyes = replace(mechanics, baseline_m=self._baseline_m)
        is_pair = protocol.command_space == PAIR
        self._inverse = Inverse(eyes) if is_pair else gaze_inverse(protocol, eyes, turns_deg)

    def activations(self, distance_m: float, error_deg: float = 0.0) -> Activations:
        """Return activations (12,) with a horizontal error before a plane, other errors 0.

        error_deg: above 0 where the eyes converge too little. Raises InputError for a gaze that the
        muscles do not reach.
        """
        protocol, inverse = self._protocol, self._inverse
        if isinstance(inverse, Inverse):
            vergence_deg = desired_vergence_deg(distance_m, self._baseline_m) - error_deg
            return inverse.activations(vergence_deg, _FRACTION, protocol.pair_limits)
        wanted_deg = dict.fromkeys(TURNED_ANGLES[protocol.command_space], 0.0)
        wanted_deg["horizontal"] = error_deg
        if protocol.fixation_iterations:
            # Of the eye itself, which turns less far where its camera is turned inward.
            left_camera_deg, right_camera_deg = self._inward_deg
            slope = self._baseline_m / distance_m - math.tan(math.radians(left_camera_deg))
            right_deg = math.degrees(math.atan(slope)) - right_camera_deg - error_deg
            wanted_deg["version"] = -right_deg / 2.0
        nowhere_aside = np.zeros(len(protocol.space.names))
        return tuple(inverse.activations(wanted_deg, distance_m, nowhere_aside).tolist())
