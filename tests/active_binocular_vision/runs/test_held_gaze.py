"""C over the least rate at the gaze that eyes have."""

import numpy as np
import pytest

from active_binocular_vision.runs.held_gaze import held_cost_ratios
from experiment_manager.measures.trials import Trials
from eye_plant import EyePlantConfig, GazeInverse
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from eye_plant.mechanics.oculomotor import Oculomotor
from lockstep import ALL_MUSCLES, COMMAND_SPACES

SPACE = COMMAND_SPACES[ALL_MUSCLES]
GAZE_DEG = {"horizontal": 0.3, "vertical": 0.0, "torsional": 0.0, "version": 5.0, "elevation": 4.0}


def test_eyes_with_the_least_energy_at_their_gaze_have_1_wherever_they_look() -> None:
    mechanics = MechanicsConfig(parameter_set="anatomical", moves="at_once")
    plant = EyePlantConfig(
        command_space=ALL_MUSCLES,
        lowest_activations=(0.0,),
        highest_activations=(1.0,),
        mechanics=mechanics,
    )
    inverse = GazeInverse(mechanics, SPACE, plant.limits.lowest, np.ones(12))
    cheapest = inverse.least(GAZE_DEG, 1.0).activations
    dearer = inverse.activations(GAZE_DEG, 1.0, np.full(12, 0.02))
    eyes, rates_w = Oculomotor(mechanics), []
    for activations in (cheapest, dearer):
        eyes.settle(activations)
        rates_w.append(eyes.settled_metabolic_rate_w().sum())
    ends = np.repeat(np.array([cheapest, dearer])[:, None], 2, axis=1)
    columns = {name: ends[..., i] for i, name in enumerate(SPACE.names)}
    columns |= {"object_distance_m": np.ones((2, 2))}
    columns |= {"metabolic_rate_w": np.repeat(np.array(rates_w)[:, None], 2, axis=1)}
    trials = Trials(SPACE, 0, np.arange(2), columns, np.zeros((2, 2), int))
    found = held_cost_ratios(trials, plant)
    assert found[0] == pytest.approx(1.0, abs=0.03)
    assert found[1] == pytest.approx(rates_w[1] / rates_w[0], rel=0.03)
    assert found[1] > 3.0
