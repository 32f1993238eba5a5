"""Settings of the learner that are refused, and those that are not looked at."""

import math
from typing import Any

import pytest

from lockstep import InputError, build
from tests.vergence_rl.small_agents import GAZE, changed
from vergence_rl import VergenceRlConfig


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"n_training_iterations": 0}, "n_training_iterations: expected 1 or more, got 0"),
        ({"cacla.discount": 1.0}, "cacla.discount: expected 0 or more, less than 1, got 1.0"),
        ({"cacla.actor_learning_rate": math.nan}, "rate: expected 0 or more, got nan"),
        ({"lowest_activations": (0.3,)}, "expected 0.3 or more for medial_rectus, .*, got 0.2"),
        ({"highest_activations": (0.2, 1.1)}, "highest_activations: expected 0 to 1, got"),
        ({"highest_activations": (0.2,) * 3}, "expected 2 entries, of medial_rectus, lateral_"),
        (
            {"command_space": "legs"},
            "command_space: expected pair or horizontal_recti or .*, got 'legs'",
        ),
        (
            {"learning_rule": "sarsa"},
            "learning_rule: expected cacla, hindsight, FILE.*, got 'sarsa'",
        ),
        (
            {"learning_rule": "hindsight", "hindsight.regression_period": 15},
            r"hindsight.regression_period: expected a multiple of 10 .*, got 15",
        ),
        (
            {"learning_rule": "hindsight", "hindsight.n_best": 10},
            r"hindsight.n_best: expected less than 10 \(iterations of vergence in a row\), got 10",
        ),
        (
            {"hindsight.exploration_variance": 0.0, "hindsight.target_noise_scale": 3.0},
            "hindsight.exploration_variance: expected more than 0 with least_noise_share or",
        ),
        (
            {"learning_rule": "hindsight", "iterations_per_episode": 1},
            "iterations_per_episode: expected 2 or more, whose rewards",
        ),
    ],
)
def test_bad_settings_are_refused(settings: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        build(VergenceRlConfig, settings)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"fixation_iterations": 2}, "fixation_iterations: expected 0, or 4 or more, of "),
        ({"iterations_per_episode": 12}, "iterations_per_episode: expected a multiple of 5"),
        ({"learning_rule": "cacla"}, "learning_rule: expected another one than cacla with sacc"),
        ({"measures_turns": True}, "measures_turns: expected false with saccades"),
        ({"hindsight.n_best": 3}, "hindsight.n_best: expected less than 3"),
        (
            {"command_space": "pair", "products_of_activations": False},
            "fixation_iterations: expected 0 with command_space pair",
        ),
    ],
)
def test_fixations_that_do_not_fit_are_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=f"^{message}"):
        changed(GAZE, changes)


def test_settings_of_the_other_rule_do_not_matter() -> None:
    settings = {"iterations_per_episode": 8, "hindsight.regression_period": 100}
    assert build(VergenceRlConfig, settings).iterations_per_episode == 8
