"""Small agents of all rules, and what they experience."""

from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lockstep import MUSCLE_NAMES, build, flatten
from vergence_rl import Agent, Decision, VergenceRlConfig
from vergence_rl.cacla.config import CaclaConfig
from vergence_rl.hindsight.config import HindsightConfig

Floats = NDArray[np.float64]
MID, HIGHEST = np.array([0.1, 0.05]), np.array([0.2, 0.1])


def changed(config: VergenceRlConfig, changes: dict[str, Any]) -> VergenceRlConfig:
    """Return a configuration with other settings, those of a rule by dotted names."""
    return build(VergenceRlConfig, flatten(config) | changes)


CACLA = VergenceRlConfig(
    n_bases=3, n_training_iterations=300, cacla=CaclaConfig(n_hidden=4, hidden_initial_width=0.5)
)
HINDSIGHT = VergenceRlConfig(
    learning_rule="hindsight",
    n_bases=3,
    iterations_per_episode=5,
    hindsight=HindsightConfig(regression_period=20, least_memory=60.0),
)
# The mean of the three best places, whose noise is tried again, a larger penalty at first, and a
# small one on activations.
MEAN = changed(
    HINDSIGHT,
    {
        "n_training_iterations": 500,
        "hindsight.n_best": 3,
        "hindsight.ridge_visits": 30.0,
        "hindsight.felt_ridge_share": 0.1,
    },
)


# Turns of the eyes in place of activations: two fixations of five iterations in each episode.
GAZE = build(
    VergenceRlConfig,
    {
        "n_bases": 3,
        "n_training_iterations": 300,
        "learning_rule": "hindsight",
        "command_space": "all_muscles",
        "lowest_activations": (0.0,),
        "highest_activations": (0.2,),
        "products_of_activations": True,
        "fixation_iterations": 5,
        "hindsight.regression_period": 10,
    },
)


@cache
def experience(now: int) -> tuple[NDArray[np.float32], Floats, float]:
    """Features, activations and reward of an observation; now and then a muscle is at a limit."""
    draw = np.random.default_rng([23, now])
    features = draw.random((2, 3)).astype(np.float32)
    activations = np.clip(draw.uniform(-0.05, 0.25, 2), 0.0, HIGHEST)
    return features, activations, float(draw.standard_normal())


def observation(config: VergenceRlConfig, now: int, **changes: Any) -> dict[str, Any]:
    """Return the arguments of Agent.observe for a training iteration.

    Of an agent that makes saccades, the first one's movement is seen and a second one follows.
    """
    features, activations, reward = experience(now)
    found: dict[str, Any] = {
        "features": features,
        "activations": activations,
        "reward": reward,
        "iteration": now % config.iterations_per_episode,
        "training_iteration": now,
        "learning": True,
        "exploration": True,
    }
    if config.n_muscles == len(MUSCLE_NAMES):
        draw, of_fixation = np.random.default_rng([29, now]), now % 5
        found |= {
            "activations": draw.uniform(0.05, 0.15, 12),
            "target_deg": np.array([1.0, 2.0]) * (1.0 if of_fixation < 2 else np.nan),
            "turns_deg": draw.normal(0, 1, (2, 3)) * (1.0 if of_fixation == 1 else np.nan),
        }
    return found | changes


def train(agent: Agent, first: int, n: int, **changes: Any) -> list[Decision]:
    """Return the decisions of n training iterations."""
    iterations = range(first, first + n)
    return [agent.observe(**observation(agent.config, t, **changes)) for t in iterations]


def trained(config: VergenceRlConfig, n: int) -> Agent:
    """Return an agent after n training iterations."""
    agent = Agent(config)
    train(agent, 0, n)
    return agent


@cache
def _state_of(config: VergenceRlConfig, n: int) -> Mapping[str, Any]:
    return trained(config, n).state()


def knowing(config: VergenceRlConfig, **changes: Any) -> tuple[Agent, int]:
    """Return an agent that has learned something, and its next training iteration.

    One that turns its eyes has just seen enough movements to know how. changes: of its settings.
    """
    n = 1700 if config.n_muscles == len(MUSCLE_NAMES) else 130
    agent, known = Agent(changed(config, changes)), _state_of(config, n)
    agent.restore({name: known.get(name, value) for name, value in agent.state().items()})
    return agent, n


def assert_same_state(state: Mapping[str, Any], expected: Mapping[str, Any]) -> None:
    """Check bits and names."""
    assert set(state) == set(expected)
    for name, array in state.items():
        np.testing.assert_array_equal(array, expected[name], err_msg=name)


def slow_state(config: VergenceRlConfig, now: int) -> Floats:
    """Return the state of an observation from all experiences so far, at once."""
    seen = [
        np.append(features.ravel().astype(np.float64) ** config.feature_exponent, activations)
        for features, activations, _ in map(experience, range(now + 1))
    ]
    if now == 0:
        return np.append(np.zeros(8), 0.02)
    spread = np.std(seen, axis=0, ddof=1)
    return np.append(0.02 * (seen[-1] - np.mean(seen, axis=0)) / spread, 0.02)
