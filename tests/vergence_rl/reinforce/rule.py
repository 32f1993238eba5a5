"""REINFORCE (Williams 1992) with a linear policy: noise that raised the reward is repeated."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tests.vergence_rl.reinforce.config import ReinforceConfig
from vergence_rl.learning_rule import Decision, Floats, Task, TimeStep, td_variance


class ReinforceRule:
    """Owns the policy's weights, and the variance of the change of reward."""

    def __init__(self, config: ReinforceConfig, task: Task) -> None:
        """Start with a policy that does nothing."""
        self._config, self._task = config, task
        self._weights = np.zeros((task.n_muscles, task.n_state))
        self._td_variance = task.initial_td_variance
        self._last: tuple[TimeStep, Floats] | None = None

    def step(
        self, observation: TimeStep, *, learning: bool, draw: np.random.Generator | None
    ) -> Decision:
        """Learn from the last action's noise, then act."""
        delta, sd = math.nan, math.sqrt(self._config.exploration_variance)
        if learning and self._last is not None and observation.follows(self._last[0]):
            before, noise = self._last
            delta = observation.reward - before.reward
            self._td_variance = td_variance(self._td_variance, delta, self._task.td_variance_rate)
            surprise = delta / math.sqrt(self._td_variance)
            rate = self._config.learning_rate
            self._weights = self._weights + rate * surprise * np.outer(noise / sd, before.state)
        noise = np.zeros(self._task.n_muscles)
        if draw is not None:
            noise = draw.normal(0.0, sd, len(noise))
        action = self._weights @ observation.state + noise
        self._last = (observation, noise) if learning else None
        command = np.clip(observation.activations + action, self._task.lowest, self._task.highest)
        rate = self._config.learning_rate
        return Decision(command, action, observation.reward, delta, self._td_variance, rate, 0.0)

    def state(self) -> dict[str, NDArray[Any]]:
        """Return weights and variance, as copies."""
        return {"policy": self._weights.copy(), "td_variance": np.array(self._td_variance)}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Continue from what state returned, with the next episode."""
        self._weights, self._td_variance = state["policy"].copy(), float(state["td_variance"])
        self._last = None
