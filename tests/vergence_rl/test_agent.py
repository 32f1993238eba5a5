import math
import re
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from lockstep.errors import DivergenceError, InputError
from lockstep.randomness import generator
from tests.vergence_rl.small_agents import (
    CACLA,
    HINDSIGHT,
    MEAN,
    MID,
    assert_same_state,
    changed,
    experience,
    slow_state,
    train,
    trained,
)
from vergence_rl.agent import Agent
from vergence_rl.config import VergenceRlConfig

WIDE = changed(CACLA, {"feature_exponent": 0.5, "cacla.exploration_variance": 2.5e-4})
of_both_rules = pytest.mark.parametrize("config", [CACLA, HINDSIGHT, MEAN])


class SlowAgent:
    """Section by section the published rules, with loops and names of their own (K17 II)."""

    def __init__(self, state: dict[str, NDArray[Any]], config: VergenceRlConfig) -> None:
        self.w1, self.w2 = state["actor_hidden"].copy(), state["actor_output"].copy()
        self.v, self.config = state["critic"].copy(), config
        self.variance = 1.0
        self.last: tuple[Any, ...] | None = None

    def observe(self, now: int) -> tuple[NDArray[np.float64], float]:
        (_, activations, r), s = experience(now), slow_state(self.config, now)
        delta = math.nan
        if now % 10 > 0:
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


@pytest.mark.parametrize(
    "config", [CACLA, changed(CACLA, {"cacla.copies_clipped_action": False}), WIDE]
)
def test_agrees_with_a_slow_agent_over_many_episodes(config: VergenceRlConfig) -> None:
    agent = Agent(config)
    slow = SlowAgent(agent.state(), config)
    n_clipped = 0
    for now in range(300):
        (got,), (action, delta) = train(agent, now, 1), slow.observe(now)
        activations = experience(now)[1]
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
        agent = trained(changed(CACLA, {"state_entries": entries}), 30)
        return agent.observe(
            features, activations, 0.0, 0, 30, learning=False, exploration=False
        ).action

    features, activations, _ = experience(30)
    before = answer(features, activations)
    differs = []
    for i in range(8):
        both = np.concatenate([features.ravel(), activations])
        both[i] += 0.05
        action = answer(both[:6].reshape(2, 3).astype(np.float32), both[6:])
        differs.append(not np.array_equal(action, before))
    assert differs == [i in range(8)[known] for i in range(8)]


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
    agent = Agent(CACLA)
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
    agent = trained(CACLA, 10)
    before = agent.state()
    decision = train(agent, 10, 1)[0]
    after = agent.state()
    assert math.isnan(decision.td_error)
    for name in ("actor_hidden", "actor_output", "critic", "td_variance", "learning_steps"):
        np.testing.assert_array_equal(after[name], before[name])


@pytest.mark.parametrize(("iteration", "now"), [(5, 5), (4, 14), (5, 4), (3, 3), (0, 4)])
def test_nothing_is_learned_after_a_gap(iteration: int, now: int) -> None:
    agent = trained(CACLA, 4)
    decision = agent.observe(*experience(7), iteration, now, learning=True, exploration=True)
    assert math.isnan(decision.td_error)
    assert agent.learning_steps == 3


def test_nothing_is_learned_from_an_action_taken_without_learning() -> None:
    agent = trained(CACLA, 3)
    agent.observe(*experience(3), 3, 3, learning=False, exploration=False)
    assert math.isnan(train(agent, 4, 1)[0].td_error)


@of_both_rules
def test_a_test_episode_changes_nothing_and_has_no_noise(config: VergenceRlConfig) -> None:
    agent = trained(config, 40)
    before = agent.state()
    answers = []
    for _ in range(2):
        for i in range(5):
            answers.append(agent.observe(*experience(i), i, 40, learning=False, exploration=False))
    assert_same_state(agent.state(), before)
    for first, second in zip(answers[:5], answers[5:], strict=True):
        np.testing.assert_array_equal(first.action, second.action)
        assert math.isnan(first.td_error)


def test_noise_is_a_function_of_seed_and_training_iteration() -> None:
    def noise(seed: int, now: int, variance: float = 1e-5) -> NDArray[np.float64]:
        agent = Agent(changed(CACLA, {"seed": seed, "cacla.exploration_variance": variance}))
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
    agent = Agent(changed(CACLA, {"cacla.exploration_variance": 1.0}))
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
    changes = {
        "n_training_iterations": 1_000_000,
        "cacla.n_hidden": 1,
        "cacla.exploration_variance": 0.0,
        "cacla.weight_shrinkage": 0.0,
        "cacla.copies_clipped_action": copies_clipped_action,
    }
    agent, silent = Agent(changed(CACLA, changes)), np.zeros(2)
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


@of_both_rules
def test_a_restored_agent_continues_bit_for_bit(config: VergenceRlConfig) -> None:
    # The sums hold episodes that the actor has not been solved for.
    agent, other = trained(config, 130), trained(config, 25)
    other.restore(agent.state())
    for one, two in zip(train(agent, 130, 100), train(other, 130, 100), strict=True):
        np.testing.assert_array_equal(one.command, two.command)
        np.testing.assert_array_equal(one.td_error, two.td_error)
    assert_same_state(other.state(), agent.state())


def test_a_restored_agent_has_no_last_action_to_learn_from() -> None:
    agent = trained(CACLA, 5)
    agent.restore(agent.state())
    assert math.isnan(train(agent, 5, 1)[0].td_error)


@of_both_rules
def test_a_state_shares_no_memory_with_the_agent(config: VergenceRlConfig) -> None:
    agent = trained(config, 40)
    state = agent.state()
    kept = {name: array.copy() for name, array in state.items()}
    agent.restore(state)
    for array in state.values():
        array[...] = 7
    assert_same_state(agent.state(), kept)


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
    _assert_refused(trained(CACLA, 20), change, message)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda s: s | {"sum_weight": np.array(0.0)}, "sum_weight: expected more than 0"),
        (lambda _: Agent(CACLA).state(), r"state: expected \['actor', 'covariance'"),
    ],
)
def test_a_bad_state_of_the_other_rule_is_refused(change, message) -> None:
    _assert_refused(trained(HINDSIGHT, 20), change, message)


def _assert_refused(agent: Agent, change, message: str) -> None:
    before = agent.state()
    with pytest.raises(InputError, match=message):
        agent.restore(change(agent.state()))
    assert_same_state(agent.state(), before)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"features": np.ones((2, 4))}, r"features: expected 6, got shape \(2, 4\)"),
        ({"features": np.full(6, np.nan)}, "features and activations: expected finite"),
        ({"activations": np.array([0.1, np.inf])}, "features and activations: expected finite"),
        (
            {"activations": np.ones(3)},
            r"activations: expected medial_rectus, lateral_rectus, got .*\(3,\)",
        ),
        ({"reward": math.nan}, "reward: expected a finite number, got nan"),
        ({"energy_penalty": math.inf}, "energy_penalty: expected a finite number, got inf"),
        ({"iteration": -1}, "iteration: expected 0 or more, got -1"),
        ({"training_iteration": -1}, "training_iteration: expected 0 or more, got -1"),
    ],
)
def test_a_bad_observation_is_refused_and_changes_nothing(changes, message) -> None:
    agent, other = trained(CACLA, 3), trained(CACLA, 3)
    good = {
        "features": np.ones(6),
        "activations": MID,
        "reward": 0.0,
        "iteration": 3,
        "training_iteration": 3,
    }
    with pytest.raises(InputError, match=message):
        agent.observe(**(good | changes), learning=True, exploration=True)
    one, two = train(agent, 3, 1)[0], train(other, 3, 1)[0]
    assert one.td_error == two.td_error
    np.testing.assert_array_equal(one.command, two.command)
    assert_same_state(agent.state(), other.state())


@pytest.mark.parametrize(
    ("settings", "quantity"),
    [
        ({"cacla.critic_learning_rate": 1e6, "cacla.critic_step_limit": 1e9}, "value|td_error"),
        ({"cacla.actor_learning_rate": 1e9}, "action"),
    ],
)
def test_divergence_ends_learning_with_iteration_and_quantity(settings, quantity) -> None:
    config = changed(CACLA, settings)
    message = rf"diverged in training iteration (\d+): ({quantity}) is .*, expected 100 at most"
    with pytest.raises(DivergenceError, match=message) as error:
        trained(config, 300)
    # Whatever was answered before was sane.
    (iteration,) = re.findall(r"iteration (\d+)", str(error.value))
    before = train(Agent(config), 0, int(iteration))
    assert max(np.abs(d.action).max() for d in before) <= 101
    assert all(math.isfinite(d.value) for d in before)


@pytest.mark.parametrize("name", ["critic", "actor_hidden", "actor_output"])
def test_weights_that_are_no_numbers_never_become_an_answer(name: str) -> None:
    agent = trained(CACLA, 20)
    rule = vars(agent)["_rule"]
    weights = {"critic": rule._critic, **vars(rule._actor)}
    weights[name.removeprefix("actor_")][...] = np.nan
    with pytest.raises(DivergenceError, match=r"iteration 20: .* is nan"):
        train(agent, 20, 1)
