"""Activations with which eyes look correctly at a plane, for all kinds of eyes."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from experiment_manager import ExperimentManagerConfig
from experiment_manager.starts import Activations, gaze_inverse
from eye_plant import Inverse, desired_vergence_deg
from eye_plant.gaze_error import wanted_gaze_deg
from eye_plant.inverse.gaze import ERRORS, LEFT_SIGHT, TURNED_ANGLES, LeastCost
from eye_plant.inverse.pair import FULL_RANGE
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from eye_plant.mechanics.oculomotor import Oculomotor
from eye_plant.turns import NO_TURNS_DEG, TurnsDeg
from lockstep import PAIR

Array = NDArray[np.float64]

AHEAD_DEG = (0.0, 0.0)
# Where on the line of pairs of equal vergence the pair begins: half-way.
_FRACTION = 0.5


class CorrectGaze:
    """Activations for the eyes of a run.

    A stereogram with parallax p on the plane is to eyes b apart what a plane is to eyes b + p
    apart, so one rule serves both. Each muscle that has a command of its own is as near to the
    tonic level as the gaze allows. Eyes that make saccades look with the left eye at a target,
    straight ahead unless another is given; others look straight ahead together. Of eyes whose
    cameras are turned, what the cameras see is correct; the pair's cameras do not count.
    """

    def __init__(
        self,
        protocol: ExperimentManagerConfig,
        mechanics: MechanicsConfig,
        turns_deg: TurnsDeg = NO_TURNS_DEG,
        parallax_m: float = 0.0,
    ) -> None:
        """turns_deg: of the cameras; parallax_m: of a stereogram, as in desired_vergence_deg."""
        self._protocol = protocol
        eyes = replace(mechanics, baseline_m=mechanics.baseline_m + parallax_m)
        self._baseline_m = eyes.baseline_m
        self._eyes = Oculomotor(eyes)
        is_pair = protocol.turning_space == PAIR
        self._pair = Inverse(eyes) if is_pair else None
        self._gaze = None if is_pair else gaze_inverse(protocol, eyes, turns_deg)

    def activations(
        self,
        distance_m: float,
        error_deg: float = 0.0,
        target_deg: Sequence[float] = AHEAD_DEG,
    ) -> Activations:
        """Return activations (12,) with a horizontal error before a plane, other errors 0.

        error_deg: above 0 where the eyes converge too little; target_deg: (2,) azimuth (right) and
        elevation from the left eye, of eyes that make saccades. Raises InputError for a gaze that
        the muscles do not reach.
        """
        if self._pair is not None:
            vergence_deg = desired_vergence_deg(distance_m, self._baseline_m) - error_deg
            return self._pair.activations(vergence_deg, _FRACTION, self._protocol.pair_limits)
        assert self._gaze is not None
        if self._protocol.fixation_iterations:
            wanted_deg = _looking_at_deg(target_deg)
        else:
            wanted_deg = dict.fromkeys(TURNED_ANGLES[self._protocol.turning_space], 0.0)
        wanted_deg["horizontal"] = error_deg
        nowhere_aside = np.zeros(len(self._protocol.space.turning.names))
        return tuple(self._gaze.activations(wanted_deg, distance_m, nowhere_aside).tolist())

    def least(self, distance_m: float, target_deg: Sequence[float]) -> LeastCost:
        """Return the cheapest activations without errors, cycloversion being free.

        Of eyes with a command for each muscle. Raises InputError for a gaze that the muscles do
        not reach.
        """
        assert self._gaze is not None
        return self._gaze.least(_looking_at_deg(target_deg), distance_m)

    def wanted_gaze_deg(self, distance_m: float, target_deg: Sequence[float]) -> Array:
        """Return azimuth (right) and elevation (2, 2) of what left and right eye look at.

        target_deg: as in `activations`, of a point on the plane.
        """
        return wanted_gaze_deg(self._eyes.eye_positions_m(), target_deg, distance_m)


def _looking_at_deg(target_deg: Sequence[float]) -> dict[str, float]:
    """Return the angles of eyes without errors whose left camera looks at a target (2,)."""
    return dict.fromkeys(ERRORS, 0.0) | dict(zip(LEFT_SIGHT, target_deg, strict=True))


class CheapestPair:
    """The cheapest pair of activations of the horizontal recti for a vergence, of any eyes."""

    def __init__(self, mechanics: MechanicsConfig) -> None:
        """mechanics: of the eyes; whatever unequal muscles let them do counts."""
        self._inverse, self._eyes = Inverse(mechanics), Oculomotor(mechanics)
        self._baseline_m = mechanics.baseline_m

    def activations(self, distance_m: float, error_deg: float) -> Activations:
        """Return activations (12,) with a vergence error before a plane.

        Raises InputError where no pair gives the vergence, or the eyes may rest elsewhere with it,
        or no pair gives the one that is correct, without which the plant shows nothing.
        """
        desired_deg = desired_vergence_deg(distance_m, self._baseline_m)
        self._inverse.check(desired_deg)
        pair = self._inverse.activation_pair(desired_deg - error_deg, 0.0, FULL_RANGE)
        return tuple(self._eyes.activations_from(*pair).tolist())
