"""The node vergence_rl: one command per observation, learned from once, and what is refused."""

import array
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from sensor_msgs.msg import JointState

from lockstep import COMMAND_SPACES, PAIR, build, flatten
from lockstep.wire.stamps import to_time
from lockstep.wire.topics import EPISODE_NAMES, TEST, TRAINING, reward_names
from lockstep.wire.vectors import vector_message
from tests.learner_contract import (
    LearnerBench,
    LearnerContract,
    changed,
    image_message,
)
from tests.node_harness import Graph
from tests.own_rule import REINFORCE
from tests.pair import ACTOR_CRITIC_NAMES, COMMAND_NAMES, HORIZONTAL_RECTI
from vergence_rl import Agent, Decision, VergenceRlConfig
from vergence_rl.messages import activations_of, actor_critic_values
from vergence_rl.node import VergenceRlNode

N_BASES = 8
SMALL = {"n_bases": N_BASES, "n_training_iterations": 100, "cacla.n_hidden": 4}
CONFIG = build(VergenceRlConfig, SMALL)
ANSWERS = {"muscle_command": JointState, "actor_critic": JointState}
ACTIVATIONS = (0.02, 0.04, 0.04, 0.06)  # medial and lateral rectus, left then right


@pytest.fixture
def bench(graph: Graph) -> LearnerBench:
    node = graph.add(VergenceRlNode, **SMALL)
    return LearnerBench(graph, node, node.inputs(), ANSWERS, _observation, refused=REFUSED)


def test_it_learns_by_a_rule_of_ones_own(graph: Graph) -> None:
    own = {"learning_rule": REINFORCE, "own_rule": "{learning_rate: 0.5}"}
    node = graph.add(VergenceRlNode, **SMALL, **own)
    assert "policy" in node.learner.state()
    assert flatten(node.config.rule_config)["learning_rate"] == 0.5


class TestContract(LearnerContract):
    """Of all learners."""


def _features(number: int) -> np.ndarray:
    return np.random.default_rng(number).random((2, N_BASES), dtype=np.float32)


def _reward(number: int) -> float:
    return -0.1 * number


def _observation(number: int, phase: int = TRAINING, **changes: float) -> dict[str, Any]:
    """Return the messages of iteration `number` of an episode, by topic; stamped with it in s."""
    stamp_ns = number * 10**9
    episode = dict.fromkeys(EPISODE_NAMES, 0.0) | {
        "phase": phase,
        "iteration": number,
        "training_iteration": number,
    }
    episode |= changes
    reward = dict.fromkeys(reward_names(), 0.0) | {"reward": _reward(number)}
    return {
        "features": image_message(_features(number), "32FC1", stamp_ns),
        "reward": vector_message(stamp_ns, tuple(reward), tuple(reward.values())),
        "episode": vector_message(stamp_ns, tuple(episode), tuple(episode.values())),
        "muscle_activations": vector_message(stamp_ns, HORIZONTAL_RECTI, ACTIVATIONS),
    }


def _decide(agent: Agent, number: int, phase: int = TRAINING) -> Decision:
    """Return what the pure agent decides on the same observation."""
    in_training = phase == TRAINING
    activations = np.array([(0.02 + 0.04) / 2, (0.04 + 0.06) / 2])
    return agent.observe(
        _features(number),
        activations,
        _reward(number),
        number,
        number,
        learning=in_training,
        exploration=in_training,
    )


def test_commands_and_thoughts_are_the_agents(bench: LearnerBench) -> None:
    agent = Agent(CONFIG)
    for number in range(4):
        bench.show(number)
        command = bench.wait_distinct("muscle_command", number + 1)[-1]
        thought = bench.wait_distinct("actor_critic", number + 1)[-1]
        decision = _decide(agent, number)
        assert command.header.stamp == thought.header.stamp == to_time(number * 10**9)
        assert tuple(command.name) == COMMAND_NAMES
        assert list(command.position) == decision.command.tolist()
        assert tuple(thought.name) == ACTOR_CRITIC_NAMES
        assert tuple(thought.position) == pytest.approx(
            actor_critic_values(decision, number), rel=0.0, abs=0.0, nan_ok=True
        )
    # Four observations of an episode are three TD updates.
    assert bench.node.learner.learning_steps == agent.learning_steps == 3


def test_activations_are_as_they_are_felt_where_that_differs() -> None:
    felt = (0.1, 0.2, 0.3, 0.4)
    message = vector_message(0, HORIZONTAL_RECTI, ACTIVATIONS, velocity=felt)
    np.testing.assert_allclose(activations_of(message, COMMAND_SPACES[PAIR]), [0.2, 0.3])


def test_thoughts_are_in_the_order_of_their_names() -> None:
    decision = Decision(
        command=np.array([0.1, 0.2]),
        action=np.array([0.6, 0.7]),
        value=0.1,
        td_error=0.2,
        td_variance=0.3,
        actor_learning_rate=0.4,
        critic_learning_rate=0.5,
    )
    assert dict(zip(ACTOR_CRITIC_NAMES, actor_critic_values(decision, 8), strict=True)) == {
        "value": 0.1,
        "td_error": 0.2,
        "td_variance": 0.3,
        "actor_learning_rate": 0.4,
        "critic_learning_rate": 0.5,
        "medial_rectus_action": 0.6,
        "lateral_rectus_action": 0.7,
        "learning_steps": 8,
    }


def test_tests_are_answered_without_noise(bench: LearnerBench) -> None:
    agent = Agent(CONFIG)
    for number in (0, 1):
        bench.show(number, TEST)
        command = bench.wait_distinct("muscle_command", number + 1)[-1]
        assert list(command.position) == _decide(agent, number, TEST).command.tolist()


def _feature(value: float) -> Callable[[dict[str, Any]], None]:
    def change(messages: dict[str, Any]) -> None:
        features = _features(1)
        features[1, 3] = value
        messages["features"] = image_message(features, "32FC1", 10**9)

    return change


def _fewer(messages: dict[str, Any]) -> None:
    messages["features"] = image_message(np.zeros((2, 4), np.float32), "32FC1", 10**9)


def _episode(**changes: float) -> Callable[[dict[str, Any]], None]:
    def change(messages: dict[str, Any]) -> None:
        messages["episode"] = _observation(1, **changes)["episode"]  # type: ignore[arg-type]

    return change


def _activation(value: float) -> Callable[[dict[str, Any]], None]:
    return changed("muscle_activations", position=array.array("d", [0.0, value, 1.0, 0.5]))


_NAN_REWARD = array.array("d", [0.0, 0.0, 0.0, 0.0, math.nan, 0.0])


REFUSED = [
    (changed("features", encoding="mono8"), "features: expected little-endian 32FC1"),
    (changed("features", is_bigendian=1), "features: expected little-endian 32FC1"),
    (changed("features", height=3), "features: expected little-endian 32FC1 with 2 rows"),
    (changed("features", width=7), "features: expected little-endian 32FC1 with 2 rows"),
    (_fewer, "features: expected 16, got shape (2, 4)"),
    (_feature(math.nan), "features: expected finite values, got NaN or infinity"),
    (changed("reward", position=_NAN_REWARD), "reward: expected finite values"),
    (_activation(1.0000001), "muscle_activations: expected activations in [0, 1]"),
    (_activation(-0.1), "muscle_activations: expected activations in [0, 1]"),
    (_episode(iteration=-1.0), "episode: expected whole numbers from 0 to 2^53"),
    (_episode(training_iteration=-1.0), "episode: expected whole numbers from 0 to 2^53"),
]
