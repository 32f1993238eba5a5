import dataclasses
import math
import re
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from lockstep.errors import DivergenceError, InputError
from lockstep.randomness import generator
from vergence_rl.agent import Agent
from vergence_rl.cacla.config import CaclaConfig
from vergence_rl.config import VergenceRlConfig
from vergence_rl.learning_rule import Decision

CONFIG = VergenceRlConfig(
    n_features=6, n_training_iterations=300, cacla=CaclaConfig(n_hidden=4, hidden_initial_width=0.5)
)
MID = np.array([0.1, 0.05])


def with_cacla(config: VergenceRlConfig, **settings: Any) -> VergenceRlConfig:
    return dataclasses.replace(config, cacla=dataclasses.replace(config.cacla, **settings))


WIDE = with_cacla(dataclasses.replace(CONFIG, feature_exponent=0.5), exploration_variance=2.5e-4)


class SlowAgent:
    """Section by section the published rules, with loops and names of their own (K17 II)."""

    def __init__(self, state: dict[str, NDArray[Any]], config: VergenceRlConfig) -> None:
        self.w1, self.w2 = state["actor_hidden"].copy(), state["actor_output"].copy()
        self.v, self.config = state["critic"].copy(), config
        self.seen: list[NDArray[np.float64]] = []
        self.variance = 1.0
        self.last: tuple[Any, ...] | None = None

    def observe(
        self, features: NDArray[Any], activations: NDArray[Any], r: float, i: int, now: int
    ) -> tuple[NDArray[np.float64], float]:
        powers = features.ravel().astype(np.float64) ** self.config.feature_exponent
        x = np.concatenate([powers, activations])
        self.seen.append(x)
        s = np.zeros(len(x) + 1)
        s[-1] = 0.02
        if len(self.seen) > 1:
            mean, spread = np.mean(self.seen, axis=0), np.std(self.seen, axis=0, ddof=1)
            s[:-1] = 0.02 * (x - mean) / spread
        delta = math.nan
        if i > 0 and self.last is not None:
            delta = self.learn(s, r, 0.5 * (1 - now / self.config.n_training_iterations))
        action = self.w2 @ np.tanh(self.w1 @ s)
        draw = generator(self.config.seed, "exploration", now)
        executed = action + draw.normal(0.0, math.sqrt(self.config.cacla.exploration_variance), 2)
        copied = executed
        if self.config.cacla.copies_clipped_action:
            copied = np.minimum(np.maximum(activations + executed, 0), [0.2, 0.1]) - activations
        self.last = (s, copied)
        return executed, delta

    def learn(self, s: NDArray[np.float64], r: float, beta: float) -> float:
        assert self.last is not None
        before, executed = self.last
        delta = r + 0.3 * (self.v @ s) - self.v @ before
        self.v = self.v + 0.75 * delta * before
        self.variance = 0.999 * self.variance + 0.001 * delta**2
        if delta > 0:
            times = math.ceil(delta / math.sqrt(self.variance))
            h = np.tanh(self.w1 @ before)
            error = executed - self.w2 @ h
            w1, w2 = self.w1 * (1 - 1e-5 * beta), self.w2.copy()
            for j in range(len(h)):
                back = sum(error[k] * self.w2[k, j] for k in range(2)) * (1 - h[j] ** 2)
                w1[j] += beta * times * back * before
                w2[:, j] += beta * times * error * h[j]
            self.w1, self.w2 = w1, w2
        return float(delta)


def experience(now: int) -> tuple[NDArray[np.float32], NDArray[np.float64], float]:
    """Random features, activations and reward of one observation."""
    draw = np.random.default_rng([17, now])
    features = draw.random((2, 3)).astype(np.float32)
    return features, draw.uniform(0.0, 0.1, 2), float(draw.standard_normal())


def train(agent: Agent, first: int, n: int, episode_length: int = 10) -> list[Decision]:
    return [
        agent.observe(*experience(t), t % episode_length, t, learning=True, exploration=True)
        for t in range(first, first + n)
    ]


@pytest.mark.parametrize("config", [CONFIG, with_cacla(CONFIG, copies_clipped_action=False), WIDE])
def test_agrees_with_a_slow_agent_over_many_episodes(config: VergenceRlConfig) -> None:
    agent = Agent(config)
    slow = SlowAgent(agent.state(), config)
    n_clipped = 0
    for now in range(300):
        features, activations, r = experience(now)
        got = agent.observe(
            features, activations, r, now % 10, now, learning=True, exploration=True
        )
        action, delta = slow.observe(features, activations, r, now % 10, now)
        np.testing.assert_allclose(got.action, action, rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(got.td_error, delta, rtol=1e-9)
        command = np.clip(activations + action, 0.0, [0.2, 0.1])
        np.testing.assert_allclose(got.command, command, atol=1e-12)
        n_clipped += int(np.any(command != activations + action))
    assert n_clipped > 10
    state = agent.state()
    np.testing.assert_allclose(state["actor_hidden"], slow.w1, rtol=1e-9)
    np.testing.assert_allclose(state["critic"], slow.v, rtol=1e-9)
    assert float(state["td_variance"]) == pytest.approx(slow.variance)
    assert agent.learning_steps == 270


@pytest.mark.parametrize(
    ("entries", "known"),
    [("all", slice(0, 8)), ("features", slice(0, 6)), ("activations", slice(6, 8))],
)
def test_what_is_hidden_from_the_learner_changes_nothing(entries: str, known: slice) -> None:
    def answer(features: NDArray[np.float32], activations: NDArray[np.float64]) -> Any:
        agent = Agent(dataclasses.replace(CONFIG, state_entries=entries))
        train(agent, 0, 30)
        return agent.observe(
            features, activations, 0.0, 0, 30, learning=False, exploration=False
        ).action

    features, activations, _ = experience(30)
    before = answer(features, activations)
    changed = []
    for i in range(8):
        both = np.concatenate([features.ravel(), activations])
        both[i] += 0.05
        action = answer(both[:6].reshape(2, 3).astype(np.float32), both[6:])
        changed.append(not np.array_equal(action, before))
    assert changed == [i in range(8)[known] for i in range(8)]


def test_default_weights_are_the_published_ones() -> None:
    state = Agent(VergenceRlConfig()).state()
    assert state["actor_hidden"].shape == (50, 803)
    assert state["actor_output"].shape == (2, 50)
    assert state["critic"].shape == (803,)
    for name, width in (
        ("actor_hidden", 1 / (803 * 50)),
        ("actor_output", 0.01),
        ("critic", 1 / 803),
    ):
        assert 0.9 * width < np.abs(state[name]).max() <= width


def test_rates_and_value_are_reported() -> None:
    agent = Agent(CONFIG)
    decision = train(agent, 0, 31)[-1]
    assert decision.actor_learning_rate == pytest.approx(0.5 * 0.9)
    assert decision.critic_learning_rate == 0.75
    entries = np.concatenate([experience(30)[0].ravel(), experience(30)[1]])
    state = agent.state()
    spread = np.sqrt(state["statistics_squared_deviation"] / 30)
    standard = 0.02 * (entries - state["statistics_mean"]) / spread
    # An episode's start learns nothing, so the critic is still the one that valued it.
    assert decision.value == pytest.approx(state["critic"] @ np.append(standard, 0.02))


def test_nothing_is_learned_across_an_episodes_start() -> None:
    agent = Agent(CONFIG)
    train(agent, 0, 10)
    before = agent.state()
    decision = train(agent, 10, 1)[0]
    after = agent.state()
    assert math.isnan(decision.td_error)
    for name in ("actor_hidden", "actor_output", "critic", "td_variance", "learning_steps"):
        np.testing.assert_array_equal(after[name], before[name])


@pytest.mark.parametrize(("iteration", "now"), [(5, 5), (4, 14), (5, 4), (3, 3), (0, 4)])
def test_nothing_is_learned_after_a_gap(iteration: int, now: int) -> None:
    agent = Agent(CONFIG)
    train(agent, 0, 4)
    decision = agent.observe(*experience(7), iteration, now, learning=True, exploration=True)
    assert math.isnan(decision.td_error)
    assert agent.learning_steps == 3


def test_nothing_is_learned_from_an_action_taken_without_learning() -> None:
    agent = Agent(CONFIG)
    train(agent, 0, 3)
    agent.observe(*experience(3), 3, 3, learning=False, exploration=False)
    assert math.isnan(train(agent, 4, 1)[0].td_error)


def test_a_test_episode_changes_nothing_and_has_no_noise() -> None:
    agent = Agent(CONFIG)
    train(agent, 0, 20)
    before = agent.state()
    answers = []
    for _ in range(2):
        for i in range(5):
            answers.append(agent.observe(*experience(i), i, 20, learning=False, exploration=False))
    for name, array in agent.state().items():
        np.testing.assert_array_equal(array, before[name])
    for first, second in zip(answers[:5], answers[5:], strict=True):
        np.testing.assert_array_equal(first.action, second.action)
        assert math.isnan(first.td_error)


def test_noise_is_a_function_of_seed_and_training_iteration() -> None:
    def noise(seed: int, now: int, variance: float = 1e-5) -> NDArray[np.float64]:
        config = VergenceRlConfig(seed=seed, n_features=6)
        agent = Agent(with_cacla(config, exploration_variance=variance))
        features = np.ones(6)
        noisy = agent.observe(features, MID, 0.0, 0, now, learning=False, exploration=True)
        calm = agent.observe(features, MID, 0.0, 0, now, learning=False, exploration=False)
        return noisy.action - calm.action

    np.testing.assert_array_equal(noise(1, 5), noise(1, 5))
    assert np.all(noise(1, 5) != noise(1, 6))
    assert np.all(noise(1, 5) != noise(2, 5))
    np.testing.assert_allclose(noise(1, 5, 4e-5), 2 * noise(1, 5))
    draws = np.array([noise(1, now) for now in range(400)])
    assert draws.std() == pytest.approx(math.sqrt(1e-5), rel=0.1)


def test_commands_stay_within_their_limits_and_actions_do_not() -> None:
    agent = Agent(with_cacla(VergenceRlConfig(n_features=6), exploration_variance=1.0))
    lowest, highest = np.zeros(2), np.array([0.2, 0.1])
    decisions = [
        agent.observe(np.ones(6), MID, 0.0, 0, now, learning=False, exploration=True)
        for now in range(50)
    ]
    commands = np.array([d.command for d in decisions])
    np.testing.assert_array_equal(commands.min(axis=0), lowest)
    np.testing.assert_array_equal(commands.max(axis=0), highest)
    assert np.abs([d.action for d in decisions]).max() > 1.0


@pytest.mark.parametrize(("copies_clipped_action", "share_left"), [(False, 1.0), (True, 0.875)])
def test_what_an_action_beyond_the_limits_teaches(copies_clipped_action, share_left) -> None:
    # Both muscles are silent and the actor relaxes them further, unchanged by any noise.
    config = with_cacla(
        VergenceRlConfig(n_features=6),
        n_hidden=1,
        exploration_variance=0.0,
        weight_shrinkage=0.0,
        copies_clipped_action=copies_clipped_action,
    )
    agent, silent = Agent(config), np.zeros(2)
    hidden = np.zeros((1, 9))
    hidden[0, -1] = math.atanh(0.5) / 0.02  # the bias input alone: the hidden unit is at 0.5
    output = np.array([[-0.2], [-0.2]])
    agent.restore(agent.state() | {"actor_hidden": hidden, "actor_output": output})
    for iteration in (0, 1):  # a good surprise of less than one standard deviation: one update
        agent.observe(
            np.ones(6), silent, 0.5, iteration, iteration, learning=True, exploration=True
        )
    # Copied is 0: W2 + beta (0 - A) h, with A = W2 h, beta = h = 0.5. Otherwise A, by itself.
    np.testing.assert_allclose(agent.state()["actor_output"], share_left * output, rtol=1e-5)


def test_a_restored_agent_continues_bit_for_bit() -> None:
    agent = Agent(CONFIG)
    train(agent, 0, 50)
    other = Agent(CONFIG)
    train(other, 0, 7)
    other.restore(agent.state())
    for one, two in zip(train(agent, 50, 50), train(other, 50, 50), strict=True):
        np.testing.assert_array_equal(one.command, two.command)
        np.testing.assert_array_equal(one.td_error, two.td_error)
    for name, array in agent.state().items():
        np.testing.assert_array_equal(array, other.state()[name])


def test_a_restored_agent_has_no_last_action_to_learn_from() -> None:
    agent = Agent(CONFIG)
    train(agent, 0, 5)
    agent.restore(agent.state())
    assert math.isnan(train(agent, 5, 1)[0].td_error)


def test_a_state_shares_no_memory_with_the_agent() -> None:
    agent = Agent(CONFIG)
    train(agent, 0, 20)
    state = agent.state()
    kept = {name: array.copy() for name, array in state.items()}
    agent.restore(state)
    for array in state.values():
        array[...] = 7
    for name, array in agent.state().items():
        np.testing.assert_array_equal(array, kept[name])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda s: s | {"critic": s["critic"][1:]}, r"critic: expected float64 of shape \(9,\)"),
        (lambda s: s | {"critic": s["critic"] * np.nan}, "critic: expected finite numbers"),
        (lambda s: s | {"actor_output": s["actor_output"].T}, r"actor_output: .*got .*\(4, 2\)"),
        (lambda s: s | {"statistics_count": np.array(-1)}, "statistics_count: expected 0 or more"),
        (
            lambda s: s | {"statistics_squared_deviation": np.full(8, -1.0)},
            "statistics_squared_deviation: expected 0 or more, got -1",
        ),
        (lambda s: s | {"td_variance": np.array(0.0)}, "td_variance: expected more than 0"),
        (lambda s: s | {"learning_steps": np.array(1.0)}, "learning_steps: expected int64"),
        (lambda s: {"critic": s["critic"]}, "state: expected"),
    ],
)
def test_a_bad_state_is_refused_and_changes_nothing(change, message) -> None:
    agent = Agent(CONFIG)
    train(agent, 0, 20)
    before = agent.state()
    with pytest.raises(InputError, match=message):
        agent.restore(change(agent.state()))
    for name, array in agent.state().items():
        np.testing.assert_array_equal(array, before[name])


@pytest.mark.parametrize(
    ("features", "activations", "reward", "iteration", "message"),
    [
        (np.ones((2, 4)), MID, 0.0, 1, r"features: expected 6, got shape \(2, 4\)"),
        (np.full(6, np.nan), MID, 0.0, 1, "features and activations: expected finite"),
        (np.ones(6), np.array([0.1, np.inf]), 0.0, 1, "features and activations: expected finite"),
        (
            np.ones(6),
            np.ones(3),
            0.0,
            1,
            r"activations: expected medial_rectus, lateral_rectus, got .*\(3,\)",
        ),
        (np.ones(6), MID, math.nan, 1, "reward: expected a finite number, got nan"),
        (np.ones(6), MID, 0.0, -1, "iteration: expected 0 or more, got -1"),
    ],
)
def test_a_bad_observation_is_refused_and_changes_nothing(
    features, activations, reward, iteration, message
) -> None:
    agent, other = Agent(CONFIG), Agent(CONFIG)
    train(agent, 0, 3)
    train(other, 0, 3)
    with pytest.raises(InputError, match=message):
        agent.observe(features, activations, reward, iteration, 3, learning=True, exploration=True)
    one, two = train(agent, 3, 1)[0], train(other, 3, 1)[0]
    assert one.td_error == two.td_error
    np.testing.assert_array_equal(one.command, two.command)


@pytest.mark.parametrize(
    ("settings", "quantity"),
    [
        ({"critic_learning_rate": 1e6, "critic_step_limit": 1e9}, "value|td_error"),
        ({"actor_learning_rate": 1e9}, "action"),
    ],
)
def test_divergence_ends_learning_with_iteration_and_quantity(settings, quantity) -> None:
    agent = Agent(with_cacla(CONFIG, **settings))
    message = rf"diverged in training iteration (\d+): ({quantity}) is .*, expected 100 at most"
    with pytest.raises(DivergenceError, match=message) as error:
        train(agent, 0, 300)
    # Whatever was answered before was sane.
    (iteration,) = re.findall(r"iteration (\d+)", str(error.value))
    before = train(Agent(with_cacla(CONFIG, **settings)), 0, int(iteration))
    assert max(np.abs(d.action).max() for d in before) <= 101
    assert all(math.isfinite(d.value) for d in before)


@pytest.mark.parametrize("name", ["critic", "actor_hidden", "actor_output"])
def test_weights_that_are_no_numbers_never_become_an_answer(name: str) -> None:
    agent = Agent(CONFIG)
    train(agent, 0, 20)
    rule = vars(agent)["_rule"]
    weights = {"critic": rule._critic, **vars(rule._actor)}
    weights[name.removeprefix("actor_")][...] = np.nan
    with pytest.raises(DivergenceError, match=r"iteration 20: .* is nan"):
        train(agent, 20, 1)
