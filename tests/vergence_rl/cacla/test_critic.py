"""Problems whose values are known, for the critic; the actor's is in test_rules.py."""

from typing import Any

import numpy as np
import pytest

from lockstep import build
from vergence_rl import Agent, Decision, VergenceRlConfig

MID = np.array([0.1, 0.05])


def config(seed: int = 1, **settings: Any) -> VergenceRlConfig:
    """A small agent with a state large enough to learn in a few hundred steps."""
    small = {
        "seed": seed,
        "n_bases": 1,
        "n_training_iterations": 6000,
        "state_standard_deviation": 0.5,
        "bias_input": 0.5,
        "cacla.n_hidden": 8,
        "cacla.hidden_initial_width": 0.5,
        "cacla.output_initial_width": 0.1,
    }
    return build(
        VergenceRlConfig, small | {f"cacla.{name}": value for name, value in settings.items()}
    )


def observe(agent: Agent, features: list[float], reward: float, i: int, now: int) -> Decision:
    return agent.observe(np.array(features), MID, reward, i, now, learning=True, exploration=True)


def valued(agent: Agent, features: list[float]) -> float:
    return agent.observe(
        np.array(features), MID, 0.0, 0, 0, learning=False, exploration=False
    ).value


def test_a_constant_reward_is_worth_its_discounted_sum() -> None:
    agent = Agent(config())
    for now in range(400):
        observe(agent, [1.0, 1.0], 2.0, now, now)
    assert valued(agent, [1.0, 1.0]) == pytest.approx(2.0 / (1.0 - 0.3), rel=1e-3)


def test_a_reward_that_depends_on_the_state() -> None:
    agent = Agent(config(discount=0.0, critic_learning_rate=0.2))
    draw = np.random.default_rng(0)
    cue = 0.0
    for now in range(2000):
        # The reward of the next observation is the cue of this one.
        reward, cue = cue, float(draw.choice([-1.0, 1.0]))
        observe(agent, [cue, 0.0], reward, now, now)
    assert valued(agent, [1.0, 0.0]) == pytest.approx(1.0, abs=0.02)
    assert valued(agent, [-1.0, 0.0]) == pytest.approx(-1.0, abs=0.02)


def test_a_delayed_reward_is_passed_back_by_the_discount() -> None:
    agent = Agent(config(discount=0.5, critic_learning_rate=0.2))
    cues = [[1.0, 0.0], [0.0, 1.0], [-1.0, -1.0]]
    for episode in range(2000):
        for i, features in enumerate(cues):
            observe(agent, features, 1.0 if i == 2 else 0.0, i, 3 * episode + i)
    # The last observation of an episode is never updated: its value is what the weights make it.
    last = valued(agent, cues[2])
    middle = valued(agent, cues[1])
    assert middle == pytest.approx(1.0 + 0.5 * last, abs=0.05)
    assert valued(agent, cues[0]) == pytest.approx(0.5 * middle, abs=0.05)
