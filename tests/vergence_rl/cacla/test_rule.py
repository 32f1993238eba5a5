import math
import re
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from lockstep import DivergenceError, generator
from tests.vergence_rl.small_agents import (
    CACLA,
    HINDSIGHT,
    MEAN,
    changed,
    experience,
    slow_state,
    train,
    trained,
)
from vergence_rl import Agent, VergenceRlConfig

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
