"""Where looks of frozen learners begin, and which learners can look at targets."""

import dataclasses

import numpy as np
from numpy.typing import NDArray

from experiment_manager.experiment.starts import gaze_inverse
from experiment_manager.frozen.learners import FrozenLearners
from experiment_manager.frozen.shown import Shown
from experiment_manager.positions.targets import wanted_angles_deg, wanted_gaze_deg
from lockstep.errors import InputError

Array = NDArray[np.float64]

_AHEAD_DEG = (0.0, 0.0)


def check_looks_at_targets(learners: FrozenLearners, shown: Shown, option: str) -> None:
    """Raise InputError, which names the option, unless the learners can look at targets."""
    if not learners.manager.protocol.fixation_iterations:
        raise InputError(
            f"{option}: expected eyes that make saccades, as those of profile gaze, got a run with "
            "protocol.fixation_iterations 0"
        )
    if shown.random_dots or shown.stereograms is not None:
        raise InputError(f"{option}: expected pictures on a plane, got stereograms")


def activations_ahead(learners: FrozenLearners, positions_m: Array, distance_m: float) -> Array:
    """Return activations (12,) with which the left eye looks straight ahead, without errors.

    positions_m: (2, 3) of the eyes. Eyes with a palsy get what healthy ones need.
    """
    healthy = dataclasses.replace(learners, settings={}).manager
    wanted_deg = wanted_angles_deg(wanted_gaze_deg(positions_m, _AHEAD_DEG, distance_m))
    nowhere_aside = np.zeros(len(healthy.protocol.space.indices))
    inverse = gaze_inverse(healthy.protocol, healthy.mechanics)
    return inverse.activations(wanted_deg, distance_m, nowhere_aside)
