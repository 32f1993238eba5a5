"""An agent that makes saccades: what its rule sees of them."""

import math

import numpy as np
import pytest

from lockstep.configuration import build, flatten
from lockstep.errors import InputError
from vergence_rl.agent import Agent
from vergence_rl.config import VergenceRlConfig
from vergence_rl.gaze.config import GazeConfig
from vergence_rl.hindsight.config import HindsightConfig
from vergence_rl.learning_rule import Decision

GAZE = VergenceRlConfig(
    n_features=6,
    n_training_iterations=300,
    iterations_per_episode=10,
    learning_rule="hindsight",
    command_space="all_muscles",
    lowest_activations=(0.0,),
    highest_activations=(0.2,),
    products_of_activations=True,
    gaze=GazeConfig(fixation_iterations=5),
    hindsight=HindsightConfig(regression_period=10),
)
MIDDLE = np.full(12, 0.1)


def _fixated(
    agent: Agent, n_episodes: int, first: int = 0, *, is_seen: bool = True
) -> list[Decision]:
    """Return the decisions of episodes of two fixations, each with two saccades.

    is_seen: whether the first saccade's movement is; without it there is no second one.
    """
    draw, decisions = np.random.default_rng(4), []
    for i in range(first * 10, (first + n_episodes) * 10):
        of_fixation = i % 5
        decisions.append(
            agent.observe(
                draw.random(6),
                draw.uniform(0.05, 0.15, 12),
                -float(draw.random()),
                i % 10,
                i,
                learning=True,
                exploration=True,
                target_deg=np.array([1.0, 2.0]) * (1.0 if of_fixation < 1 + is_seen else np.nan),
                turns_deg=draw.normal(0, 1, (2, 3))
                * (1.0 if is_seen and of_fixation == 1 else np.nan),
            )
        )
    return decisions


def test_a_rule_learns_from_what_follows_the_saccades_alone() -> None:
    agent = Agent(GAZE)
    decisions = _fixated(agent, 2)
    # A saccade reports no TD error, and neither does the first iteration of vergence.
    undefined = [math.isnan(d.td_error) for d in decisions]
    assert undefined == [True, True, True, False, False] * 4
    assert agent.state()["left_eye_n_movements"] == 4
    assert agent.state()["sum_weight"] > 0.0
    # As for all eyes: one step for each iteration but the first of an episode.
    assert agent.learning_steps == 18


def test_products_of_activations_are_of_one_eye() -> None:
    assert GAZE.n_felt == 12 + 2 * 21
    agent = Agent(GAZE)
    _fixated(agent, 1)
    means = agent.state()["statistics_mean"]
    assert len(means) == 6 + 2 * 21 + 12
    assert 0.005 < means[6:48].min() < means[6:48].max() < 0.02


def test_gaze_goes_on_from_its_state_bit_for_bit() -> None:
    whole, part = Agent(GAZE), Agent(GAZE)
    _fixated(whole, 3)
    part.restore(whole.state())
    for one, other in zip(_fixated(whole, 2, 3), _fixated(part, 2, 3), strict=True):
        assert one.command.tobytes() == other.command.tobytes()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"gaze.fixation_iterations": 3}, "expected 0, or 4 or more, of which 2 are saccades"),
        ({"iterations_per_episode": 12}, "iterations_per_episode: expected a multiple of 5"),
        ({"hindsight.n_best": 3}, "hindsight.n_best: expected less than 3"),
        (
            {"command_space": "pair", "products_of_activations": False},
            "gaze.fixation_iterations: expected 0 with command_space pair",
        ),
    ],
)
def test_fixations_that_do_not_fit_are_refused(changes, message: str) -> None:
    with pytest.raises(InputError, match=message):
        build(VergenceRlConfig, flatten(GAZE) | changes)


def test_vergence_is_learned_after_a_saccade_that_was_not_seen() -> None:
    agent = Agent(GAZE)
    decisions = _fixated(agent, 2, is_seen=False)
    assert [math.isnan(d.td_error) for d in decisions] == [True, True, True, False, False] * 4
    assert agent.state()["left_eye_n_movements"] == 0
    assert agent.state()["actor"].any()
    assert agent.learning_steps == 18


@pytest.mark.parametrize("n_best", [1, 2])
def test_as_many_best_places_as_a_fixation_has(n_best: int) -> None:
    agent = Agent(build(VergenceRlConfig, flatten(GAZE) | {"hindsight.n_best": n_best}))
    _fixated(agent, 4)
    assert agent.state()["actor"].any()
