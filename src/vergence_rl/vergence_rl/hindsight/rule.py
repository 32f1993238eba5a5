"""Hindsight regression as a learning rule: it collects an episode, then learns from all of it."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vergence_rl.hindsight.config import HindsightConfig
from vergence_rl.hindsight.limits import freed_targets, made_up, within_limits
from vergence_rl.hindsight.noise import FirstNoise, floored, root_of, widened
from vergence_rl.hindsight.regression import (
    Sums,
    first_sums,
    nearness,
    regressed_actor,
    residual_covariance,
    weights_of_ranks,
)
from vergence_rl.learning_rule import Decision, Floats, Task, TimeStep, td_variance


@dataclass(frozen=True)
class _Visit:
    """One place of an episode.

    asked: (n_muscles,) activations that led to it, before the limits; at the episode's start its
    own. noise: (n_muscles,) their exploration.
    """

    seen: TimeStep
    asked: Floats
    noise: Floats


class HindsightRule:
    """Owns the sums of the regression, the actor that was last solved from them, and its residuals.

    In its decisions, value is the largest reward of the episode so far (in a test, the reward), and
    td_error by how much the reward exceeds the largest one before it: above zero, these are the
    best activations by now. actor_learning_rate is the share of the sums that an episode replaces.
    """

    def __init__(self, config: HindsightConfig, task: Task) -> None:
        """Start with an actor that does nothing, and wide noise."""
        self._config, self._task = config, task
        self._limits = task.lowest, task.highest
        self._rank_weights = weights_of_ranks(config.n_best)
        # The last entries of the state are what is felt and the constant.
        self._ridge_shares = np.ones(task.n_state)
        self._ridge_shares[-task.n_felt - 1 :] = config.felt_ridge_share
        self._first = FirstNoise(task.n_muscles, config.exploration_variance, config.starts_share)
        self._weights = np.zeros((task.n_muscles, task.n_state))
        self._begin()
        self._td_variance = task.initial_td_variance
        self._visits: list[_Visit] = []
        self._asked = self._noise = np.zeros(task.n_muscles)

    def _begin(self) -> None:
        """Know nothing but the first noise."""
        n_state = self._task.n_state
        self._covariance = self._first.covariance
        self._sums = first_sums(n_state, self._covariance, self._config.least_memory)
        self._selected = self._covariance.copy()

    def step(
        self, observation: TimeStep, *, learning: bool, draw: np.random.Generator | None
    ) -> Decision:
        """Collect the observation, learn from the episode if it is its last one, then act."""
        value, delta = observation.reward, math.nan
        if learning:
            value, delta = self._collect(observation)
        else:
            self._visits.clear()
        action = self._weights @ observation.state
        self._noise = np.zeros_like(action)
        if draw is not None:
            self._noise = root_of(self._covariance) @ draw.normal(0.0, 1.0, len(action))
            action = action + self._noise
        self._asked = observation.activations + action
        return Decision(
            within_limits(self._asked, self._covariance, *self._limits),
            action,
            value,
            delta,
            self._td_variance,
            1.0 - self._kept_share(observation.training_iteration),
            0.0,
        )

    def _collect(self, observation: TimeStep) -> tuple[float, float]:
        """Return the largest reward so far, and by how much the last exceeds those before it.

        Of places that are compared; where there is none, the reward of now.
        """
        visits = self._visits
        if not (visits and observation.follows(visits[-1].seen)):
            visits.clear()
            self._asked = observation.activations
        delta, best = math.nan, self._best_reward()
        if best is not None and observation.is_compared:
            delta = observation.reward - best
            rate = self._task.td_variance_rate
            self._td_variance = td_variance(self._td_variance, delta, rate)
        visits.append(_Visit(observation, self._asked, self._noise))
        if len(visits) == self._task.iterations_per_episode == observation.iteration + 1:
            self._learn_from_episode(observation.training_iteration + 1)
        best = self._best_reward()
        return observation.reward if best is None else best, delta

    def _best_reward(self) -> float | None:
        """Return the largest reward of the places that are compared."""
        rewards = (visit.seen.reward for visit in self._visits if visit.seen.is_compared)
        return max(rewards, default=None)

    def state(self) -> dict[str, NDArray[Any]]:
        """Return actor, sums and residuals, as copies; of symmetric squares the upper triangle."""
        return {
            "actor": self._weights.copy(),
            "covariance": self._covariance.copy(),
            "sum_products": self._sums.products.copy(),
            "sum_squares": self._sums.squares[np.triu_indices(self._task.n_state)],
            "sum_targets": self._sums.targets.copy(),
            "sum_weight": np.array(self._sums.weight),
            "td_variance": np.array(self._td_variance),
            **({"selected_noise": self._selected.copy()} if self._config.n_best > 1 else {}),
            **self._first.state(),
        }

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Continue from what state returned, with the next episode."""
        n_state = self._task.n_state
        squares = np.zeros((n_state, n_state))
        squares[np.triu_indices(n_state)] = state["sum_squares"]
        squares += np.triu(squares, 1).T
        self._sums = Sums(
            float(state["sum_weight"]),
            squares,
            state["sum_products"].copy(),
            state["sum_targets"].copy(),
        )
        self._weights = state["actor"].copy()
        self._first.restore(state)
        self._covariance = state["covariance"].copy()
        if self._config.n_best > 1:
            self._selected = state["selected_noise"].copy()
        self._td_variance = float(state["td_variance"])
        self._visits.clear()

    def _learn_from_episode(self, n_seen: int) -> None:
        """Add an episode's visits to the sums, and now and then solve the regression.

        n_seen: training iterations by now.
        """
        config = self._config
        states = np.array([visit.seen.state for visit in self._visits])
        visited = np.array([visit.seen.activations for visit in self._visits])
        if not self._first.is_known:
            if self._first.add(visited[0]):
                self._begin()
            return
        # What is not compared comes last.
        rewards = [v.seen.reward if v.seen.is_compared else -math.inf for v in self._visits]
        order = np.argsort(np.negative(rewards), kind="stable")
        kept = self._kept_share(n_seen)
        if config.n_best == 1:
            aim = visited[order[0]]
            wanted = visited + states @ self._weights.T
            targets = freed_targets(aim, wanted, self._covariance, *self._limits) - visited
        else:
            aim = self._mean_of_best(order, visited)
            targets = aim - visited
        weights = self._nearness(aim - visited)
        self._sums.add(states, targets, weights, kept=kept)
        if config.n_best > 1:
            self._note_noise(order, kept)
        if n_seen % config.regression_period == 0:
            ridge_share = config.ridge_share + config.ridge_visits / self._memory(n_seen)
            self._weights = regressed_actor(self._sums, ridge_share * self._ridge_shares)
            if config.exploration_follows_residuals:
                covariance = (
                    residual_covariance(self._sums, self._weights)
                    if config.n_best == 1
                    else self._selected.copy()
                )
                least = config.least_noise_share**2
                self._covariance = (
                    widened(covariance, least * self._first.covariance) if least else covariance
                )

    def _nearness(self, targets: Floats) -> Floats:
        """Return the weights (n_visits,) of targets (n_visits, n).

        Measured in the noise, a target is far where the reward depends on it, however many other
        directions there are in which it does not.
        """
        config = self._config
        if not config.target_noise_scale:
            return nearness(targets @ self._first.metric, config.target_scale)
        return nearness(
            targets @ np.linalg.inv(root_of(floored(self._covariance))), config.target_noise_scale
        )

    def _note_noise(self, order: NDArray[np.intp], kept: float) -> None:
        """Remember which noise led to the best places.

        order: (n_visits,) from the best place to the worst. The first place is nobody's noise.
        Remembered is what the limits left of it, so that it falls where muscles are silent.
        """
        weights = self._rank_weights
        best = [self._visits[i] for i in order[order > 0][: len(weights)]]
        carried_out = np.array(
            [v.noise + self._cut(v.asked) - self._cut(v.asked - v.noise) for v in best]
        )
        self._selected = (
            kept * self._selected + (1.0 - kept) * (weights * carried_out.T) @ carried_out
        )

    def _cut(self, asked: Floats) -> Floats:
        """Return what the limits change in a command (n_muscles,)."""
        return within_limits(asked, self._covariance, *self._limits) - asked

    def _mean_of_best(self, order: NDArray[np.intp], visited: Floats) -> Floats:
        """Return the target (n_muscles,) of the best places.

        order: (n_visits,) from the best place to the worst. Where the best places were asked for
        beyond a limit on average, the target stays there, and the other muscles make up for it.
        """
        weights = self._rank_weights
        best = order[: len(weights)]
        asked: Floats = weights @ np.array([visit.asked for visit in self._visits])[best]
        place: Floats = weights @ visited[best]
        held = (asked < self._task.lowest) | (asked > self._task.highest)
        return made_up(place, asked, self._covariance, held) if held.any() else place

    def _kept_share(self, n_seen: int) -> float:
        """Return what an episode leaves of the sums before it."""
        return float(np.exp(-self._task.iterations_per_episode / self._memory(n_seen)))

    def _memory(self, n_seen: int) -> float:
        return max(self._config.least_memory, self._config.memory_share * n_seen)
