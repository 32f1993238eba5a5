"""Muscles that a command does not name hold what they were last told."""

import dataclasses

import numpy as np
import pytest

from eye_plant.config import EyePlantConfig
from eye_plant.episode import Episode
from eye_plant.plant import EyePlant
from eye_plant.stimuli.stimulus_set import StimulusSet
from lockstep.command_space import ALL_MUSCLES, MUSCLE_NAMES
from lockstep.errors import InputError
from tests.pair import HORIZONTAL_RECTI, pair_activations

EPISODE = Episode.alone(0, 2.0, pair_activations(0.05, 0.02), n_iterations=5)


def test_each_command_adds_to_those_before_it() -> None:
    picture = np.zeros((64, 64), dtype=np.uint8)
    plant = EyePlant(EyePlantConfig(), StimulusSet((picture,), (picture,)))
    recti = [MUSCLE_NAMES.index(name) for name in HORIZONTAL_RECTI]

    def told(*names: str, values: list[float]) -> list[float]:
        observation = plant.execute(plant.targets(names, np.array(values)))
        found: list[float] = observation.state.activations[recti].tolist()
        return found

    try:
        plant.begin(EPISODE)
        # left medial, left lateral, right medial, right lateral
        expected = [0.1, 0.02, 0.05, 0.02]
        assert told("left_medial_rectus", values=[0.1]) == pytest.approx(expected)
        expected = [0.1, 0.02, 0.05, 0.03]
        assert told("right_lateral_rectus", values=[0.03]) == pytest.approx(expected)
        plant.begin(dataclasses.replace(EPISODE, first_observation=10))
        expected = [0.05, 0.02, 0.05, 0.04]
        assert told("right_lateral_rectus", values=[0.04]) == pytest.approx(expected)
    finally:
        plant.close()


def test_a_command_of_muscles_with_their_own_names_all_of_them() -> None:
    picture = np.zeros((64, 64), dtype=np.uint8)
    config = EyePlantConfig(command_space=ALL_MUSCLES, lowest_activations=(0.0,))
    plant = EyePlant(config, StimulusSet((picture,), (picture,)))
    try:
        with pytest.raises(
            InputError, match=r"expected left_medial_rectus, .*, as command_space al"
        ):
            plant.targets(MUSCLE_NAMES[:6], np.zeros(6))
        values = np.linspace(0.0, 0.11, 12)
        in_reverse = plant.targets(MUSCLE_NAMES[::-1], values[::-1])
        assert in_reverse.tolist() == values.tolist()
    finally:
        plant.close()
