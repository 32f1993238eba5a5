"""The agent: features, activations and reward in, a muscle command out."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lockstep import DivergenceError, InputError, generator
from vergence_rl.config import VergenceRlConfig
from vergence_rl.focusing import FocusingRule
from vergence_rl.gaze.control import GazeControl, checked_gaze
from vergence_rl.gaze.turning import TurningRule
from vergence_rl.learning_rule import (
    NO_TARGET_DEG,
    NO_TURNS_DEG,
    Decision,
    LearningRule,
    TimeStep,
)
from vergence_rl.normalizer import (
    RunningStatistics,
    empty_statistics,
    normalized,
    updated_statistics,
)
from vergence_rl.rules import rule_of

# Rewards are about -0.2 and activations end at 1: a hundred times that means divergence.
_SANE = {"value": 100.0, "td_error": 100.0, "action": 100.0}


class Agent:
    """Owns the normaliser's statistics and a learning rule.

    learning_steps: training iterations so far that had a predecessor in their episode to learn
    from.

    Example:
        >>> import numpy as np
        >>> from vergence_rl import Agent, VergenceRlConfig
        >>> agent, place = Agent(VergenceRlConfig(n_bases=3)), np.array([0.1, 0.05])
        >>> for i in range(10):  # an episode
        ...     decision = agent.observe(
        ...         np.ones(6), place, -0.2, i, i, learning=True, exploration=True
        ...     )
        ...     place = decision.command
        >>> agent.learning_steps
        9
    """

    def __init__(self, config: VergenceRlConfig) -> None:
        """Start with the weights of the seed."""
        self.config = config
        rule: LearningRule = rule_of(config.learning_rule)(config.rule_config, config.eyes_task)
        if config.learns_turns:
            holds_gaze = config.fixation_iterations > 0
            control = GazeControl(*config.limit_arrays, config.gaze, holds_gaze=holds_gaze)
            rule = TurningRule(rule, control, config.iterations_per_fixation, config.n_before)
        if config.n_lenses:
            tasks = config.eyes_task, *config.lens_tasks
            n_held = config.lens.looking_iterations
            rule = FocusingRule(rule, tasks, config.lens_config, n_held, config.limit_arrays)
        self._rule = rule
        self.learning_steps = 0
        self._last: TimeStep | None = None
        self._hidden = {
            "all": slice(0),
            "features": slice(config.n_features, None),
            "activations": slice(config.n_features),
        }[config.state_entries]
        self._n_of_eyes = config.scales.n_for_eyes * config.n_bases
        self._statistics = empty_statistics(
            config.n_features + config.n_felt, config.initial_squared_deviation
        )
        turning = config.space.turning
        self._pairs = np.triu_indices(len(turning.names) // turning.n_eyes)

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
        target_deg: NDArray[np.float64] = NO_TARGET_DEG,
        turns_deg: NDArray[np.float64] = NO_TURNS_DEG,
        energy_penalty: float = 0.0,
        leading_eye: float = 0,
    ) -> Decision:
        """Learn from what was done so far and answer with what to do next.

        features: (n_scales, n_bases) or any shape of that size, where there are lenses all 0 at
        the scales for the eyes while one eye sees nothing; activations: (n_muscles,) of now,
        those that are commanded; reward: r_t, of now; iteration: within the episode, from 0;
        training_iteration: number of training iterations before this one; learning: whether to
        learn from the last action, and later from this one (there is nothing to learn at an
        episode's start or after a gap); exploration: whether to add noise to the action;
        target_deg: (2,) place to look at now, sideways and up from the line of sight of the eye
        that leads, NaN where there is none; turns_deg: (2, 3) how each eye was seen to turn since
        the observation before, NaN where that was not seen; energy_penalty: lambda C, what the
        activations take from the reward; leading_eye: 0 the left one, 1 the right one.

        Raises InputError, and changes nothing, for a wrong size or a number that is not finite;
        DivergenceError when value, TD error or action leave every sane range.
        """
        entries = self._checked_entries(features, activations)
        _check_numbers(
            {"reward": reward, "energy_penalty": energy_penalty},
            {"iteration": iteration, "training_iteration": training_iteration},
        )
        target_deg, turns_deg, leads = checked_gaze(target_deg, turns_deg, leading_eye)
        if learning:
            self._statistics = updated_statistics(self._statistics, entries)
        observation = TimeStep(
            iteration,
            training_iteration,
            self._state_vector(entries),
            entries[-self.config.n_muscles :],
            reward,
            target_deg,
            turns_deg,
            energy_penalty,
            leads,
            is_binocular=bool(entries[: self._n_of_eyes].any()),
        )
        seed = self.config.seed
        draw = generator(seed, "exploration", training_iteration) if exploration else None
        decision = self._rule.step(observation, learning=learning, draw=draw)
        _check_sanity(training_iteration, decision)
        if learning and self._last is not None and observation.follows(self._last):
            self.learning_steps += 1
        self._last = observation if learning else None
        return decision

    def state(self) -> dict[str, NDArray[Any]]:
        """Return all that learning has changed, for restore at an episode's start, as copies."""
        return self._rule.state() | {
            "learning_steps": np.array(self.learning_steps),
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
        self.learning_steps, self._last = int(state["learning_steps"]), None
        self._statistics = RunningStatistics(
            int(state["statistics_count"]),
            state["statistics_mean"].copy(),
            state["statistics_squared_deviation"].copy(),
        )

    def _checked_entries(
        self, features: NDArray[Any], activations: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return features, products and activations as one vector, (n_features + n_felt,)."""
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
        entries = np.concatenate((powers, self._products(activations), activations))
        if not np.isfinite(entries).all():
            raise InputError("features and activations: expected finite numbers, got others")
        return entries

    def _products(self, activations: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the products of two activations of one eye, squares included, (n_products,)."""
        if not self.config.products_of_activations:
            return np.zeros(0)
        turning = self.config.space.turning
        of_eyes = activations[: len(turning.names)].reshape(turning.n_eyes, -1)
        first, second = self._pairs
        return np.ravel(of_eyes[:, first] * of_eyes[:, second])

    def _state_vector(self, entries: NDArray[np.float64]) -> NDArray[np.float64]:
        standard = normalized(self._statistics, entries, self.config.state_standard_deviation)
        standard[self._hidden] = 0.0
        return np.append(standard, self.config.bias_input)


def _check_numbers(finite: Mapping[str, float], counts: Mapping[str, int]) -> None:
    for name, number in finite.items():
        if not math.isfinite(number):
            raise InputError(f"{name}: expected a finite number, got {number}")
    for name, count in counts.items():
        if count < 0:
            raise InputError(f"{name}: expected 0 or more, got {count}")


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
        is_count = np.issubdtype(array.dtype, np.integer)
        if (is_count or name == "statistics_squared_deviation") and np.any(got < 0):
            raise InputError(f"{name}: expected 0 or more, got {np.min(got)}")
    for name in {"td_variance", "sum_weight"} & set(state):
        if not state[name] > 0.0:
            raise InputError(f"{name}: expected more than 0, got {state[name]}")
