"""What eyes spend over the least with which they could hold the gaze that they have.

C* of a test without gaze targets is that of eyes whose version is free, so eyes that look aside
may spend more than C* for their gaze alone.
"""

import contextlib

import numpy as np
from numpy.typing import NDArray

from experiment_manager.measures.trials import Trials
from eye_plant import EyePlantConfig, GazeInverse
from eye_plant.inverse.gaze import GAZE_ANGLES
from eye_plant.inverse.least_cost import DEAR
from lockstep import ALL_MUSCLES, COMMAND_SPACES, InputError

# Each takes some hundredths of a second.
_N_TRIALS = 14


def held_cost_ratios(trials: Trials, plant: EyePlantConfig) -> NDArray[np.float64]:
    """Return C over the least C with the same gaze and errors, (n,), of some trials' ends.

    trials: with a command for each muscle. What the muscles do not reach is left out.
    """
    space = COMMAND_SPACES[ALL_MUSCLES]
    assert trials.space == space
    lowest, highest = plant.limits.lowest, np.ones(len(space.names))
    inverse = GazeInverse(plant.mechanics, space, lowest, highest, plant.camera.turns_deg)
    chosen = np.unique(np.linspace(0, len(trials.trial) - 1, _N_TRIALS).astype(int))
    ends = trials.activations[chosen, -1].astype(np.float64)
    ratios = []
    for activations, distance_m, rate_w in zip(
        ends, trials.object_distance_m[chosen], trials.metabolic_rate_w[chosen, -1], strict=True
    ):
        gaze_deg = inverse.gaze_deg(activations, float(distance_m))
        wanted_deg = dict(zip(GAZE_ANGLES, gaze_deg.tolist(), strict=True))
        with contextlib.suppress(InputError):
            least = inverse.least(wanted_deg, float(distance_m), dear=DEAR)
            ratios.append(rate_w / least.metabolic_rate_w)
    found = np.array(ratios)
    return found[np.isfinite(found) & (found > 0.0)]
