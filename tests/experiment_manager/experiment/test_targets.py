import numpy as np
import pytest

from experiment_manager.experiment.config import ProtocolConfig
from experiment_manager.experiment.targets import drawn_targets_deg
from lockstep.command_space import ALL_MUSCLES
from lockstep.configuration import build, flatten
from lockstep.errors import InputError

CONFIG = ProtocolConfig(
    command_space=ALL_MUSCLES,
    lowest_activations=(0.0,),
    highest_activations=(0.2,),
    fixation_iterations=5,
    target_distance_deg=(2.0, 10.0),
    largest_target_deg=(8.0, 6.0),
)


def drawn(gaze_deg: tuple[float, float], seed: int) -> np.ndarray:
    draw = np.random.default_rng(seed)
    return np.array(drawn_targets_deg(CONFIG, 20, gaze_deg, draw)).reshape(-1, 2)


def test_targets_are_within_range_and_at_a_drawn_distance_from_one_another() -> None:
    for seed in range(50):
        targets_deg = drawn((1.0, -2.0), seed)
        assert targets_deg.shape == (4, 2)
        assert (np.abs(targets_deg) <= (8.0, 6.0)).all()
        steps = np.diff(np.vstack([(1.0, -2.0), targets_deg]), axis=0)
        away_deg = np.hypot(*steps.T)
        assert ((away_deg >= 2.0) & (away_deg <= 10.0)).all()


def test_all_directions_are_drawn() -> None:
    steps = np.array([drawn((0.0, 0.0), seed)[0] for seed in range(200)])
    quadrants = {(x > 0, y > 0) for x, y in steps}
    assert len(quadrants) == 4


def test_eyes_that_look_too_far_aside_come_back() -> None:
    np.testing.assert_array_equal(np.abs(drawn((40.0, 0.0), 1)[0, 0]), 8.0)


@pytest.mark.parametrize("name", ["iterations_per_episode", "iterations_per_trial"])
def test_episodes_and_trials_are_whole_fixations(name: str) -> None:
    settings = flatten(CONFIG) | {"iterations_per_episode": 20, name: 8}
    with pytest.raises(InputError, match=rf"{name}: expected a multiple of 5 \(fixation_iter"):
        build(ProtocolConfig, settings)


def test_the_pair_makes_no_saccades() -> None:
    with pytest.raises(InputError, match="fixation_iterations: expected 0 with command_space pair"):
        ProtocolConfig(fixation_iterations=5)
