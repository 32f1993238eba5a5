"""Hindsight regression as a learning rule: it collects an episode, then learns from all of it."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vergence_rl.config import N_MUSCLES, VergenceRlConfig
from vergence_rl.hindsight import (
    Sums,
    first_sums,
    kept_share,
    nearness,
    regressed_actor,
    residual_covariance,
    root_of,
)
from vergence_rl.learning_rule import Moment, Opinion
from vergence_rl.limits import freed_targets, within_limits
from vergence_rl.td import td_variance


class HindsightRule:
    """Owns the sums of the regression, the actor that was last solved from them, and its residuals.

    In its opinions, value is the largest reward of the episode so far, and td_error by how much the
    reward exceeds the largest one before it: above zero, this is the best place by now.
    actor_learning_rate is the share of the sums that an episode replaces.
    """

    def __init__(self, config: VergenceRlConfig) -> None:
        """Start with an actor that does nothing, and wide noise."""
        self.config = config
        self.learning_steps = 0
        self._weights = np.zeros((N_MUSCLES, config.n_state))
        self._sums = first_sums(
            config.n_state, N_MUSCLES, config.exploration_variance, config.least_memory
        )
        self._covariance = config.exploration_variance * np.eye(N_MUSCLES)
        self._td_variance = config.initial_td_variance
        self._visits: list[Moment] = []

    def learn(self, moment: Moment) -> Opinion:
        """Collect the moment, and learn from the episode if it is its last."""
        visits = self._visits
        if visits and moment.follows(visits[-1]):
            self.learning_steps += 1
        else:
            visits.clear()
        delta = math.nan
        if visits:
            delta = moment.reward - max(visit.reward for visit in visits)
            self._td_variance = td_variance(self._td_variance, delta, self.config.td_variance_rate)
        visits.append(moment)
        best = max(visit.reward for visit in visits)
        if len(visits) == self.config.iterations_per_episode == moment.iteration + 1:
            self._learn_from_episode(moment.training_iteration + 1)
        return self._opinion(moment, best, delta)

    def judge(self, moment: Moment) -> Opinion:
        """Report the reward of a moment of a test."""
        self._visits.clear()
        return self._opinion(moment, moment.reward, math.nan)

    def action(self, state: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return A(s) = W s."""
        return self._weights @ state

    def noise(self, draw: np.random.Generator) -> NDArray[np.float64]:
        """Return Gaussian noise of the residuals' covariance (D16)."""
        return root_of(self._covariance) @ draw.normal(0.0, 1.0, N_MUSCLES)

    def command(self, wanted: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the nearest activations within the limits, as the covariance measures it (D16)."""
        return within_limits(wanted, self._covariance, *self.config.limits)

    def acted(
        self, moment: Moment, action: NDArray[np.float64], command: NDArray[np.float64]
    ) -> None:
        """Nothing to note: where an action led is seen in the next moment."""

    def state(self) -> dict[str, NDArray[Any]]:
        """Return actor, sums and residuals, as copies; of symmetric squares the upper triangle."""
        return {
            "actor": self._weights.copy(),
            "covariance": self._covariance.copy(),
            "learning_steps": np.array(self.learning_steps),
            "sum_products": self._sums.products.copy(),
            "sum_squares": self._sums.squares[np.triu_indices(self.config.n_state)],
            "sum_targets": self._sums.targets.copy(),
            "sum_weight": np.array(self._sums.weight),
            "td_variance": np.array(self._td_variance),
        }

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Continue from what state returned, with the next episode."""
        n_state = self.config.n_state
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
        self._covariance = state["covariance"].copy()
        self.learning_steps = int(state["learning_steps"])
        self._td_variance = float(state["td_variance"])
        self._visits.clear()

    def _learn_from_episode(self, n_seen: int) -> None:
        """Add an episode's visits to the sums, and now and then solve the regression.

        n_seen: training iterations by now.
        """
        config = self.config
        states = np.array([visit.state for visit in self._visits])
        places = np.array([visit.activations for visit in self._visits])
        best = places[np.argmax([visit.reward for visit in self._visits])]
        wanted = places + states @ self._weights.T
        targets = freed_targets(best, wanted, self._covariance, *config.limits) - places
        weights = nearness(best - places, config.target_scale)
        self._sums.add(states, targets, weights, kept=self._kept_share(n_seen))
        if n_seen % config.regression_period == 0:
            self._weights = regressed_actor(self._sums, config.ridge_share)
            if config.exploration_follows_residuals:
                self._covariance = residual_covariance(self._sums, self._weights)

    def _kept_share(self, n_seen: int) -> float:
        config = self.config
        memory = max(config.least_memory, config.memory_share * n_seen)
        return kept_share(config.iterations_per_episode, memory)

    def _opinion(self, moment: Moment, best: float, delta: float) -> Opinion:
        replaced = 1.0 - self._kept_share(moment.training_iteration)
        return Opinion(best, delta, self._td_variance, replaced, 0.0)
