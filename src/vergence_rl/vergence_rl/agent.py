"""The agent: features, activations and reward in, a muscle command out."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lockstep.errors import DivergenceError, InputError
from lockstep.randomness import generator
from vergence_rl.cacla.rule import CaclaRule
from vergence_rl.config import VergenceRlConfig
from vergence_rl.hindsight.rule import HindsightRule
from vergence_rl.learning_rule import Decision, LearningRule, Observation
from vergence_rl.normalizer import (
    RunningStatistics,
    empty_statistics,
    normalized,
    updated_statistics,
)

# Rewards are about -0.2 and activations end at 1: a hundred times that means divergence.
_SANE = {"value": 100.0, "td_error": 100.0, "action": 100.0}
_RULES: dict[str, Any] = {"cacla": CaclaRule, "hindsight": HindsightRule}


class Agent:
    """Owns the normaliser's statistics and a learning rule."""

    def __init__(self, config: VergenceRlConfig) -> None:
        """Start with the weights of the seed."""
        self.config = config
        rule = _RULES[config.learning_rule]
        self._rule: LearningRule = rule(config.rule_config, config.task)
        self._hidden = {
            "all": slice(0),
            "features": slice(config.n_features, None),
            "activations": slice(config.n_features),
        }[config.state_entries]
        self._statistics = empty_statistics(
            config.n_features + config.n_muscles, config.initial_squared_deviation
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
        observation = Observation(
            iteration,
            training_iteration,
            self._state_vector(entries),
            entries[-self.config.n_muscles :],
            reward,
        )
        draw = (
            generator(self.config.seed, "exploration", training_iteration) if exploration else None
        )
        decision = self._rule.step(observation, learning=learning, draw=draw)
        _check_sanity(training_iteration, decision)
        return decision

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
        if np.shape(activations) != (self.config.n_muscles,):
            raise InputError(
                f"activations: expected {', '.join(self.config.space.names)}, got shape "
                f"{np.shape(activations)}"
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
        standard[self._hidden] = 0.0
        return np.append(standard, self.config.bias_input)


def _check_sanity(training_iteration: int, decision: Decision) -> None:
    """Raise DivergenceError for a quantity beyond its limit; weights that are not show in them."""
    largest_action = float(np.abs(decision.action).max())
    quantities = {"value": decision.value, "td_error": decision.td_error, "action": largest_action}
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
