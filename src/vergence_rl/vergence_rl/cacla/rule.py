"""CACLA+VAR as a learning rule: a linear critic, and an actor that copies what did better."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lockstep import generator
from vergence_rl.cacla.actor import (
    ActorOutput,
    ActorWeights,
    actor,
    actor_rate,
    actor_step,
    n_updates,
)
from vergence_rl.cacla.config import CaclaConfig
from vergence_rl.cacla.critic import bounded_rate, critic_step, td_error, value
from vergence_rl.learning_rule import Decision, Floats, Task, TimeStep, td_variance


@dataclass(frozen=True)
class _Experience:
    """What the next observation of the episode needs of this one to learn.

    copied: (n_muscles,) action that the actor is to copy, should it have done well.
    """

    observation: TimeStep
    output: ActorOutput
    copied: Floats


class CaclaRule:
    """Owns the critic's and the actor's weights and the variance of the TD error.

    In its decisions, value is V(s_t) and td_error delta_t, both by the weights before this
    observation's update; actor_learning_rate is beta_t, critic_learning_rate alpha, unbounded.
    """

    def __init__(self, config: CaclaConfig, task: Task) -> None:
        """Start with random weights, a function of the seed."""
        self._config, self._task = config, task
        n_state, n_hidden = task.n_state, config.n_hidden
        of_critic = config.critic_initial_width or 1.0 / n_state
        of_hidden = config.hidden_initial_width or 1.0 / (n_state * n_hidden)
        of_output = config.output_initial_width
        draw = generator(task.seed, "weights", 0)
        self._critic = draw.uniform(-of_critic, of_critic, n_state)
        self._actor = ActorWeights(
            draw.uniform(-of_hidden, of_hidden, (n_hidden, n_state)),
            draw.uniform(-of_output, of_output, (task.n_muscles, n_hidden)),
        )
        self._td_variance = task.initial_td_variance
        self._last: _Experience | None = None

    def step(
        self, observation: TimeStep, *, learning: bool, draw: np.random.Generator | None
    ) -> Decision:
        """Learn from the last action of the episode, if there is one, then act."""
        value_t, delta = value(self._critic, observation.state), math.nan
        if learning and self._last is not None and observation.follows(self._last.observation):
            delta = self._learn(self._last, observation, value_t)
        output = actor(self._actor, observation.state)
        action = output.action
        if draw is not None:
            standard_deviation = math.sqrt(self._config.exploration_variance)
            action = action + draw.normal(0.0, standard_deviation, len(action))
        command = np.clip(observation.activations + action, self._task.lowest, self._task.highest)
        # What the limits have left of the action is what the actor may copy (D14).
        change = command - observation.activations
        copied = change if self._config.copies_clipped_action else action
        self._last = _Experience(observation, output, copied) if learning else None
        return Decision(
            command,
            action,
            value_t,
            delta,
            self._td_variance,
            self._rate(observation),
            self._config.critic_learning_rate,
        )

    def state(self) -> dict[str, NDArray[Any]]:
        """Return weights and variance, as copies."""
        return {
            "actor_hidden": self._actor.hidden.copy(),
            "actor_output": self._actor.output.copy(),
            "critic": self._critic.copy(),
            "td_variance": np.array(self._td_variance),
        }

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Continue from what state returned, with the next episode."""
        self._actor = ActorWeights(state["actor_hidden"].copy(), state["actor_output"].copy())
        self._critic = state["critic"].copy()
        self._td_variance = float(state["td_variance"])
        self._last = None

    def _learn(self, last: _Experience, observation: TimeStep, value_t: float) -> float:
        """Update critic and actor for the last state and action; return the TD error."""
        config, state_tm1 = self._config, last.observation.state
        value_tm1 = value(self._critic, state_tm1)
        delta = td_error(observation.reward, config.discount, value_t, value_tm1)
        alpha = bounded_rate(config.critic_learning_rate, state_tm1, config.critic_step_limit)
        self._critic = critic_step(self._critic, state_tm1, delta, alpha)
        self._td_variance = td_variance(self._td_variance, delta, self._task.td_variance_rate)
        n = n_updates(delta, self._td_variance)
        if n > 0:
            rate = self._rate(observation)
            self._actor = actor_step(
                self._actor,
                state_tm1,
                last.output,
                last.copied,
                rate=rate * n,
                shrinkage=rate * config.weight_shrinkage,
            )
        return delta

    def _rate(self, observation: TimeStep) -> float:
        return actor_rate(
            self._config.actor_learning_rate,
            observation.training_iteration,
            self._task.n_training_iterations,
        )
