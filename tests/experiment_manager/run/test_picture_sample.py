"""Pictures of every n-th episode and trial are recorded."""

import dataclasses

import pytest

from experiment_manager import ExperimentManagerConfig
from experiment_manager.run.picture_sample import takes_pictures
from eye_plant import Episode
from lockstep.wire.topics import TEST, TRAINING
from tests.pair import pair_activations


@pytest.mark.parametrize(
    ("phase", "number", "expected"),
    [
        (TRAINING, 0, True),
        (TRAINING, 49, False),
        (TRAINING, 50, True),
        (TEST, 0, True),
        (TEST, 50, False),
        (TEST, 14, True),
    ],
)
def test_sampled_episodes(phase: int, number: int, expected: bool) -> None:
    config = ExperimentManagerConfig(pictures_every_n_episodes=50, pictures_every_n_trials=7)
    alone = Episode.alone(0, 1.0, pair_activations(0.1, 0.0), n_iterations=2)
    # A training episode is counted by itself, a trial within its test.
    episode, trial = (number, -1) if phase == TRAINING else (1, number)
    sampled = dataclasses.replace(alone, phase=phase, episode=episode, trial=trial)
    assert takes_pictures(config, sampled) is expected
