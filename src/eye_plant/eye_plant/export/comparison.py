"""By how much plain MuJoCo with the exported file differs from the plant."""

from dataclasses import dataclass
from itertools import product

import mujoco
import numpy as np
from numpy.typing import NDArray

from eye_plant.mechanics.model import MechanicsConfig
from eye_plant.mechanics.muscles import LATERAL, MEDIAL
from eye_plant.mechanics.oculomotor import Oculomotor

Array = NDArray[np.float64]

# The activations of the paper's experiments, in steps of a fifth.
PAIRS = list(product(np.linspace(0.0, 0.2, 6), np.linspace(0.0, 0.1, 6)))
LONG_S = 10.0


@dataclass(frozen=True)
class Difference:
    """Largest difference of any angle of either eye over the map, from the plant's equilibrium.

    after_period_deg: after one control period from the keyframe; after_long_deg: after 10 s.
    """

    period_s: float
    after_period_deg: float
    after_long_deg: float


def gaze_map_deg(eyes: Oculomotor) -> Array:
    """Return the plant's angles at each pair of activations, (36, 2 eyes, 3 axes)."""
    rows = []
    for pair in PAIRS:
        eyes.settle(eyes.activations_from(*pair))
        rows.append(np.degrees(eyes.state().eye_angles_rad))
    return np.array(rows)


def simulated_map_deg(model: mujoco.MjModel, tonic: Array, duration_s: float) -> Array:
    """Return plain MuJoCo's angles so long after a command from the keyframe, as `gaze_map_deg`.

    tonic: (12,) activations that the muscles keep which are not commanded.
    """
    data = mujoco.MjData(model)
    rows = []
    for medial, lateral in PAIRS:
        mujoco.mj_resetDataKeyframe(model, data, 0)
        data.ctrl[:] = tonic
        data.ctrl[MEDIAL], data.ctrl[LATERAL] = medial, lateral
        mujoco.mj_step(model, data, round(duration_s / model.opt.timestep))
        rows.append(np.degrees(data.qpos).reshape(2, 3))
    return np.array(rows)


def difference(parameter_set: str, mjcf: str) -> Difference:
    """Measure the exported text against the plant of the same parameter set."""
    eyes = Oculomotor(MechanicsConfig(parameter_set=parameter_set))
    model = mujoco.MjModel.from_xml_string(mjcf)
    rest_deg = gaze_map_deg(eyes)

    def largest_deg(duration_s: float) -> float:
        found_deg = simulated_map_deg(model, eyes.tonic_activations, duration_s)
        return float(np.abs(found_deg - rest_deg).max())

    period_s = eyes.config.period_s
    return Difference(period_s, largest_deg(period_s), largest_deg(LONG_S))
