"""A learning rule of one's own: REINFORCE (Williams 1992) with a linear policy.

Noise that raised the reward is repeated. A run learns with it by
--set vergence_rl.learning_rule=docs/examples/reinforce.py:ReinforceRule
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from lockstep import check_settings, setting
from vergence_rl import Decision, Task, TimeStep


@dataclass(frozen=True)
class ReinforceConfig:
    """Settings of policy and exploration."""

    turns_eyes: ClassVar[bool] = False

    learning_rate: float = setting(0.002, "learning rate of the policy", least=0)
    exploration_variance: float = setting(1e-4, "variance of the noise on each action", above=0)

    def __post_init__(self) -> None:
        """Refuse values out of range."""
        check_settings(self)

    def check_fits(self, iterations_per_episode: int, n_visits: int) -> None:
        """Accept episodes of any length."""


class ReinforceRule:
    """Owns the policy's weights, and the running variance of the change of reward."""

    settings = ReinforceConfig

    def __init__(self, config: ReinforceConfig, task: Task) -> None:
        """Start with a policy that does nothing."""
        self._config, self._task = config, task
        self._weights = np.zeros((task.n_muscles, task.n_state))
        self._variance = task.initial_td_variance
        self._last: tuple[TimeStep, NDArray[np.float64]] | None = None

    def step(
        self, observation: TimeStep, *, learning: bool, draw: np.random.Generator | None
    ) -> Decision:
        """Learn from the last action's noise, then act."""
        delta, sd = math.nan, math.sqrt(self._config.exploration_variance)
        rate = self._config.learning_rate
        if learning and self._last is not None and observation.follows(self._last[0]):
            before, noise = self._last
            delta = observation.reward - before.reward
            share = self._task.td_variance_rate
            self._variance = (1.0 - share) * self._variance + share * delta**2
            surprise = delta / math.sqrt(self._variance)
            self._weights = self._weights + rate * surprise * np.outer(noise / sd, before.state)
        noise = np.zeros(self._task.n_muscles)
        if draw is not None:
            noise = draw.normal(0.0, sd, len(noise))
        action = self._weights @ observation.state + noise
        self._last = (observation, noise) if learning else None
        command = np.clip(observation.activations + action, self._task.lowest, self._task.highest)
        return Decision(command, action, observation.reward, delta, self._variance, rate, 0.0)

    def state(self) -> dict[str, NDArray[Any]]:
        """Return weights and variance, as copies."""
        return {"policy": self._weights.copy(), "td_variance": np.array(self._variance)}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Continue from what state returned, with the next episode."""
        self._weights, self._variance = state["policy"].copy(), float(state["td_variance"])
        self._last = None
