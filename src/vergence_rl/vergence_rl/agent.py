"""The agent: features, activations and reward in, a muscle command out."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lockstep.errors import DivergenceError, InputError
from lockstep.randomness import generator
from vergence_rl.cacla_rule import CaclaRule
from vergence_rl.config import N_MUSCLES, VergenceRlConfig
from vergence_rl.hindsight_rule import HindsightRule
from vergence_rl.learning_rule import LearningRule, Moment
from vergence_rl.normalizer import (
    RunningStatistics,
    empty_statistics,
    normalized,
    updated_statistics,
)

# Rewards are about -0.2 and activations end at 1: whatever is a hundred times that has run away.
_SANE = {"value": 100.0, "td_error": 100.0, "action": 100.0}
_RULES: dict[str, type[CaclaRule] | type[HindsightRule]] = {
    "cacla": CaclaRule,
    "hindsight": HindsightRule,
}


@dataclass(frozen=True)
class Decision:
    """The answer to one observation.

    command: (n_muscles,) target activations of medial and lateral rectus, within their limits;
    action: (n_muscles,) executed change of activation, noise included, before the limits. What
    follows is the learning rule's opinion. By CACLA, value: V(s_t), and td_error: delta_t, by the
    weights before this observation's update; actor_learning_rate: beta_t; critic_learning_rate:
    alpha, unbounded. By hindsight, see `HindsightRule`. td_error is NaN where there is nothing to
    learn from; td_variance: its running variance.
    """

    command: NDArray[np.float64]
    action: NDArray[np.float64]
    value: float
    td_error: float
    td_variance: float
    actor_learning_rate: float
    critic_learning_rate: float


class Agent:
    """Owns the normaliser's statistics and a learning rule."""

    def __init__(self, config: VergenceRlConfig) -> None:
        """Start with the weights of the seed."""
        self.config = config
        self._rule: LearningRule = _RULES[config.learning_rule](config)
        self._statistics = empty_statistics(
            config.n_features + N_MUSCLES, config.initial_squared_deviation
        )

    @property
    def learning_steps(self) -> int:
        """Training iterations so far that had a predecessor in their episode to learn from."""
        return self._rule.learning_steps

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
        """Learn from what was done so far and answer with what to do next.

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
        before, state = entries[-N_MUSCLES:], self._state_vector(entries)
        moment = Moment(iteration, training_iteration, state, before, reward)
        opinion = self._rule.learn(moment) if learning else self._rule.judge(moment)
        action = self._rule.action(state)
        _check_sanity(
            training_iteration,
            {
                "value": opinion.value,
                "td_error": opinion.td_error,
                "action": float(np.abs(action).max()),
            },
        )
        if exploration:
            draw = generator(self.config.seed, "exploration", training_iteration)
            action = action + self._rule.noise(draw)
        command = self._rule.command(before + action)
        if learning:
            self._rule.acted(moment, action, command)
        return Decision(
            command,
            action,
            opinion.value,
            opinion.td_error,
            opinion.td_variance,
            opinion.actor_learning_rate,
            opinion.critic_learning_rate,
        )

    def state(self) -> dict[str, NDArray[Any]]:
        """Return all that learning has changed, for restore at an episode's start, as copies."""
        return self._rule.state() | {
            "statistics_count": np.array(self._statistics.count),
            "statistics_mean": self._statistics.mean.copy(),
            "statistics_squared_deviation": self._statistics.squared_deviation.copy(),
        }

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Continue from what state returned, bit for bit, with the next episode.

        Raises InputError, and changes nothing, unless it holds finite arrays of this
        configuration's names, shapes and types, with counts and variances that can be.
        """
        _check_state(state, self.state())
        self._rule.restore(state)
        self._statistics = RunningStatistics(
            int(state["statistics_count"]),
            state["statistics_mean"].copy(),
            state["statistics_squared_deviation"].copy(),
        )

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
    for name in {"td_variance", "sum_weight"} & set(state):
        if not state[name] > 0.0:
            raise InputError(f"{name}: expected more than 0, got {state[name]}")
