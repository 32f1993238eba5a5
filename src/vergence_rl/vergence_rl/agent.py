"""The actor-critic: features, activations and reward in, a muscle command out."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lockstep.errors import DivergenceError, InputError
from lockstep.randomness import generator
from vergence_rl.cacla import actor_step, n_updates
from vergence_rl.config import N_MUSCLES, VergenceRlConfig
from vergence_rl.exploration import exploration_sd, step_scale
from vergence_rl.networks import ActorOutput, ActorWeights, actor, uniform_weights
from vergence_rl.normalizer import (
    RunningStatistics,
    empty_statistics,
    normalized,
    updated_statistics,
)
from vergence_rl.td import (
    bounded_rate,
    critic_step,
    declining_rate,
    td_error,
    td_variance,
    value,
)

# Rewards are about -0.2 and activations end at 1: whatever is a hundred times that has run away.
_SANE = {"value": 100.0, "td_error": 100.0, "action": 100.0}


@dataclass(frozen=True)
class Decision:
    """The answer to one observation.

    command: (n_muscles,) target activations of medial and lateral rectus, within their limits;
    action: (n_muscles,) executed change of activation, noise included, before clipping;
    value: V(s_t), and td_error: delta_t, by the weights before this observation's update;
    td_error is NaN where nothing was learned; td_variance: its running variance;
    actor_learning_rate: beta_t; critic_learning_rate: alpha,
    unbounded.
    """

    command: NDArray[np.float64]
    action: NDArray[np.float64]
    value: float
    td_error: float
    td_variance: float
    actor_learning_rate: float
    critic_learning_rate: float


@dataclass(frozen=True)
class _Experience:
    """What the next observation of the episode needs of this one to learn.

    action: (n_muscles,) that the actor is to copy, should it have done well; noise_sd: of the
    exploration that it was drawn with.
    """

    iteration: int
    training_iteration: int
    state: NDArray[np.float64]
    output: ActorOutput
    action: NDArray[np.float64]
    noise_sd: float


class Agent:
    """Owns the normaliser's statistics, the critic's and the actor's weights."""

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
        self._statistics = empty_statistics(
            config.n_features + N_MUSCLES, config.initial_squared_deviation
        )
        self._td_variance = config.initial_td_variance
        self._lowest, self._highest = np.array([config.medial_limits, config.lateral_limits]).T
        self._last: _Experience | None = None

    def observe(
        self,
        features: NDArray[Any],
        activations: NDArray[np.float64],
        reward: float,
        iteration: int,
        training_iteration: int,
        *,
        learning: bool,
        exploration: bool,
    ) -> Decision:
        """Learn from the last action and answer with the next one.

        features: (2, n_features / 2) or any shape of that size; activations: (n_muscles,) of now;
        reward: r_t, of now; iteration: within the episode, from 0; training_iteration: number of
        training iterations before this one. There is nothing to learn at an episode's start or
        after a gap, nor from an action that was taken without learning.
        Raises InputError, and changes nothing, for a wrong size or a number that is not finite;
        DivergenceError when value, TD error or action leave every sane range.
        """
        entries = self._checked_entries(features, activations, reward, iteration)
        if learning:
            self._statistics = updated_statistics(self._statistics, entries)
        state = self._state_vector(entries)
        value_t = value(self._critic, state)
        rate = declining_rate(
            self.config.actor_learning_rate, training_iteration, self.config.n_training_iterations
        )
        last = self._predecessor(iteration, training_iteration) if learning else None
        delta = math.nan if last is None else self._learn(last, reward, value_t, rate)
        output = actor(self._actor, state)
        noise_sd = self._exploration_sd(training_iteration)
        action = output.action
        _check_sanity(
            training_iteration, {"value": value_t, "td_error": delta, "action": _largest(action)}
        )
        if exploration:
            action = action + self._noise(training_iteration, noise_sd)
        before = entries[-N_MUSCLES:]
        command = np.clip(before + action, self._lowest, self._highest)
        copied = command - before if self.config.copies_clipped_action else action
        self._last = (
            _Experience(iteration, training_iteration, state, output, copied, noise_sd)
            if learning
            else None
        )
        return Decision(
            command,
            action,
            value_t,
            delta,
            self._td_variance,
            rate,
            self.config.critic_learning_rate,
        )

    def state(self) -> dict[str, NDArray[Any]]:
        """Return all that learning has changed, for restore at an episode's start, as copies."""
        return {
            "actor_hidden": self._actor.hidden.copy(),
            "actor_output": self._actor.output.copy(),
            "critic": self._critic.copy(),
            "learning_steps": np.array(self.learning_steps),
            "statistics_count": np.array(self._statistics.count),
            "statistics_mean": self._statistics.mean.copy(),
            "statistics_squared_deviation": self._statistics.squared_deviation.copy(),
            "td_variance": np.array(self._td_variance),
        }

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Continue from what state returned, bit for bit, with the next episode.

        Raises InputError, and changes nothing, unless it holds finite arrays of this
        configuration's names, shapes and types, with counts and variances that can be.
        """
        _check_state(state, self.state())
        self._actor = ActorWeights(state["actor_hidden"].copy(), state["actor_output"].copy())
        self._critic = state["critic"].copy()
        self.learning_steps = int(state["learning_steps"])
        self._statistics = RunningStatistics(
            int(state["statistics_count"]),
            state["statistics_mean"].copy(),
            state["statistics_squared_deviation"].copy(),
        )
        self._td_variance = float(state["td_variance"])
        self._last = None

    def _checked_entries(
        self,
        features: NDArray[Any],
        activations: NDArray[np.float64],
        reward: float,
        iteration: int,
    ) -> NDArray[np.float64]:
        """Return features and activations as one vector, (n_features + n_muscles,)."""
        n_features = self.config.n_features
        if np.size(features) != n_features:
            raise InputError(f"features: expected {n_features}, got shape {np.shape(features)}")
        if np.shape(activations) != (N_MUSCLES,):
            raise InputError(
                f"activations: expected medial and lateral, got shape {np.shape(activations)}"
            )
        powers = np.ravel(features).astype(np.float64)
        if self.config.feature_exponent != 1.0:
            powers = np.power(powers, self.config.feature_exponent)
        entries = np.concatenate((powers, activations))
        if not np.isfinite(entries).all():
            raise InputError("features and activations: expected finite numbers, got others")
        if not math.isfinite(reward):
            raise InputError(f"reward: expected a finite number, got {reward}")
        if iteration < 0:
            raise InputError(f"iteration: expected 0 or more, got {iteration}")
        return entries

    def _state_vector(self, entries: NDArray[np.float64]) -> NDArray[np.float64]:
        standard = normalized(self._statistics, entries, self.config.state_standard_deviation)
        return np.append(standard, self.config.bias_input)

    def _predecessor(self, iteration: int, training_iteration: int) -> _Experience | None:
        """Return the last experience if this observation follows it directly."""
        last = self._last
        if last is None:
            return None
        steps = (iteration - last.iteration, training_iteration - last.training_iteration)
        return last if steps == (1, 1) else None

    def _learn(self, last: _Experience, r_t: float, value_t: float, rate: float) -> float:
        """Update critic and actor for the last state and action; return the TD error."""
        config = self.config
        delta = td_error(r_t, config.discount, value_t, value(self._critic, last.state))
        alpha = bounded_rate(config.critic_learning_rate, last.state, config.critic_step_limit)
        self._critic = critic_step(self._critic, last.state, delta, alpha)
        self._td_variance = td_variance(self._td_variance, delta, config.td_variance_rate)
        n = n_updates(delta, self._td_variance)
        if n > 0:
            self._actor = actor_step(
                self._actor,
                last.state,
                last.output,
                last.action,
                rate=rate * n * step_scale(last.noise_sd, config.exploration_step_exponent),
                shrinkage=rate * config.weight_shrinkage,
            )
        self.learning_steps += 1
        return delta

    def _exploration_sd(self, training_iteration: int) -> float:
        config = self.config
        return exploration_sd(
            math.sqrt(config.exploration_variance),
            config.wide_exploration_share,
            config.final_exploration_share,
            min(1.0, training_iteration / config.n_training_iterations),
        )

    def _noise(self, training_iteration: int, sd: float) -> NDArray[np.float64]:
        draw = generator(self.config.seed, "exploration", training_iteration)
        return draw.normal(0.0, sd, N_MUSCLES)


def _largest(values: NDArray[np.float64]) -> float:
    return float(np.abs(values).max())


def _check_sanity(training_iteration: int, quantities: Mapping[str, float]) -> None:
    """Raise DivergenceError for a quantity beyond its limit; weights that are not show in them."""
    for name, quantity in quantities.items():
        limit = _SANE[name]
        if name == "td_error" and math.isnan(quantity):
            continue  # nothing was learned
        if not abs(quantity) <= limit:  # also true of NaN
            raise DivergenceError(
                f"vergence_rl diverged in training iteration {training_iteration}: {name} is "
                f"{quantity:g}, expected {limit:g} at most"
            )


def _check_state(state: Mapping[str, NDArray[Any]], expected: Mapping[str, NDArray[Any]]) -> None:
    if set(state) != set(expected):
        raise InputError(f"state: expected {sorted(expected)}, got {sorted(state)}")
    for name, array in expected.items():
        got = state[name]
        if got.shape != array.shape or got.dtype != array.dtype:
            raise InputError(
                f"{name}: expected {array.dtype} of shape {array.shape}, "
                f"got {got.dtype} of shape {got.shape}"
            )
        if not np.isfinite(got).all():
            raise InputError(f"{name}: expected finite numbers, got others")
    for name in ("learning_steps", "statistics_count", "statistics_squared_deviation"):
        if np.any(state[name] < 0):
            raise InputError(f"{name}: expected 0 or more, got {np.min(state[name])}")
    if not state["td_variance"] > 0.0:
        raise InputError(f"td_variance: expected more than 0, got {state['td_variance']}")
