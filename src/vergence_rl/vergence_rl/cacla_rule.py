"""The published rule: a linear critic, and an actor that copies what did better (K17 II)."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lockstep.randomness import generator
from vergence_rl.cacla import actor_step, n_updates
from vergence_rl.config import N_MUSCLES, VergenceRlConfig
from vergence_rl.learning_rule import Moment, Opinion
from vergence_rl.networks import ActorOutput, ActorWeights, actor, uniform_weights
from vergence_rl.td import (
    bounded_rate,
    critic_step,
    declining_rate,
    td_error,
    td_variance,
    value,
)


@dataclass(frozen=True)
class _Experience:
    """What the next moment of the episode needs of this one to learn.

    copied: (n_muscles,) action that the actor is to copy, should it have done well.
    """

    moment: Moment
    output: ActorOutput
    copied: NDArray[np.float64]


class CaclaRule:
    """Owns the critic's and the actor's weights and the variance of the TD error."""

    def __init__(self, config: VergenceRlConfig) -> None:
        """Start with random weights, a function of the seed."""
        self.config = config
        self.learning_steps = 0
        n_state, n_hidden = config.n_state, config.n_hidden
        critic_width = config.critic_initial_width or 1.0 / n_state
        hidden_width = config.hidden_initial_width or 1.0 / (n_state * n_hidden)
        draw = generator(config.seed, "weights", 0)
        self._critic = uniform_weights(draw, (n_state,), critic_width)
        self._actor = ActorWeights(
            uniform_weights(draw, (n_hidden, n_state), hidden_width),
            uniform_weights(draw, (N_MUSCLES, n_hidden), config.output_initial_width),
        )
        self._td_variance = config.initial_td_variance
        self._output = actor(self._actor, np.zeros(n_state))
        self._last: _Experience | None = None

    def learn(self, moment: Moment) -> Opinion:
        """Learn from the last action of the episode; at its start there is none."""
        value_t, delta = value(self._critic, moment.state), math.nan
        if self._last is not None and moment.follows(self._last.moment):
            delta = self._step(self._last, moment, value_t)
        return self._opinion(moment, value_t, delta)

    def judge(self, moment: Moment) -> Opinion:
        """Value a moment of a test."""
        self._last = None
        return self._opinion(moment, value(self._critic, moment.state), math.nan)

    def action(self, state: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return A(s), and remember how it came about."""
        self._output = actor(self._actor, state)
        return self._output.action

    def noise(self, draw: np.random.Generator) -> NDArray[np.float64]:
        """Return Gaussian noise, of the same width throughout (K17 II)."""
        return draw.normal(0.0, math.sqrt(self.config.exploration_variance), N_MUSCLES)

    def command(self, wanted: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the activations, each cut off at its own limits."""
        return np.clip(wanted, *self.config.limits)

    def acted(
        self, moment: Moment, action: NDArray[np.float64], command: NDArray[np.float64]
    ) -> None:
        """Keep what the actor is to copy: what the limits have left of the action (D14)."""
        change = command - moment.activations
        copied = change if self.config.copies_clipped_action else action
        self._last = _Experience(moment, self._output, copied)

    def state(self) -> dict[str, NDArray[Any]]:
        """Return weights and variance, as copies."""
        return {
            "actor_hidden": self._actor.hidden.copy(),
            "actor_output": self._actor.output.copy(),
            "critic": self._critic.copy(),
            "learning_steps": np.array(self.learning_steps),
            "td_variance": np.array(self._td_variance),
        }

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Continue from what state returned, with the next episode."""
        self._actor = ActorWeights(state["actor_hidden"].copy(), state["actor_output"].copy())
        self._critic = state["critic"].copy()
        self.learning_steps = int(state["learning_steps"])
        self._td_variance = float(state["td_variance"])
        self._last = None

    def _step(self, last: _Experience, moment: Moment, value_t: float) -> float:
        """Update critic and actor for the last state and action; return the TD error."""
        config, state_tm1 = self.config, last.moment.state
        delta = td_error(moment.reward, config.discount, value_t, value(self._critic, state_tm1))
        alpha = bounded_rate(config.critic_learning_rate, state_tm1, config.critic_step_limit)
        self._critic = critic_step(self._critic, state_tm1, delta, alpha)
        self._td_variance = td_variance(self._td_variance, delta, config.td_variance_rate)
        n = n_updates(delta, self._td_variance)
        if n > 0:
            rate = self._rate(moment)
            self._actor = actor_step(
                self._actor,
                state_tm1,
                last.output,
                last.copied,
                rate=rate * n,
                shrinkage=rate * config.weight_shrinkage,
            )
        self.learning_steps += 1
        return delta

    def _rate(self, moment: Moment) -> float:
        config = self.config
        return declining_rate(
            config.actor_learning_rate, moment.training_iteration, config.n_training_iterations
        )

    def _opinion(self, moment: Moment, value_t: float, delta: float) -> Opinion:
        alpha = self.config.critic_learning_rate
        return Opinion(value_t, delta, self._td_variance, self._rate(moment), alpha)
