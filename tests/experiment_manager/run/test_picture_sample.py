"""Pictures of every n-th episode and trial are recorded."""

import pytest

from experiment_manager.experiment.config import ExperimentManagerConfig
from experiment_manager.run.picture_sample import takes_pictures
from eye_plant.episode import Episode
from lockstep.wire.topics import TEST, TRAINING
from tests.pair import pair_activations


def _episode(phase: int = TRAINING, number: int = 3, n_iterations: int = 2) -> Episode:
    return Episode(
        phase=phase,
        test=-1 if phase == TRAINING else 0,
        trial=-1 if phase == TRAINING else number,
        episode=number,
        training_iteration=30,
        stimulus=0,
        object_distance_m=1.0,
        activations=pair_activations(0.1, 0.0),
        n_iterations=n_iterations,
        first_observation=40,
    )


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
    assert takes_pictures(config, _episode(phase, number)) is expected
