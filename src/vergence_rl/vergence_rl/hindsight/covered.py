"""Turning the eyes while one of them is covered: by what is felt alone."""

import dataclasses
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vergence_rl.hindsight.config import HindsightConfig
from vergence_rl.hindsight.rule import HindsightRule
from vergence_rl.learning_rule import Decision, LearningRule, Task, TimeStep

# Without features no target is met exactly: distant ones count as well. So few entries need hardly
# any ridge.
_TARGET_SCALE, _RIDGE_SHARE = 0.1, 1e-4
_FELT = "felt_"


class CoveredRule:
    """Stands before a rule, and decides in its place while one eye sees nothing.

    Features of one image say nothing of disparity, and the weights of what is felt beside them are
    those of eyes that see. So the same visits are regressed a second time, on what is felt alone: a
    lens that focuses nearer then turns the eyes inwards (accommodative vergence).
    """

    def __init__(self, rule: LearningRule, task: Task, n_focusing: int) -> None:
        """Stand before a rule of that task.

        n_focusing: iterations of an episode, its first, after which lenses tell of the distance.
        """
        self._rule, self._n_told, self._n_focusing = rule, task.n_felt + 1, n_focusing
        n_iterations = task.iterations_per_episode - n_focusing
        task = dataclasses.replace(task, n_state=self._n_told, iterations_per_episode=n_iterations)
        config = HindsightConfig(target_scale=_TARGET_SCALE, ridge_share=_RIDGE_SHARE)
        self._felt = HindsightRule(config, task)

    def step(
        self, observation: TimeStep, *, learning: bool, draw: np.random.Generator | None
    ) -> Decision:
        """Let both learn, and one of them decide."""
        since = observation.iteration - self._n_focusing
        state = observation.state[-self._n_told :]
        felt = dataclasses.replace(observation, state=state, iteration=since)
        sees, tells = observation.is_binocular, learning and since >= 0
        by_sight = self._rule.step(observation, learning=learning, draw=draw if sees else None)
        by_feel = self._felt.step(felt, learning=tells, draw=None if sees else draw)
        return by_sight if sees else by_feel

    def state(self) -> dict[str, NDArray[Any]]:
        """Return all that both have learned, as copies."""
        felt = {f"{_FELT}{name}": array for name, array in self._felt.state().items()}
        return self._rule.state() | felt

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Continue from what state returned, with the next episode."""
        self._rule.restore(state)
        self._felt.restore({name: state[f"{_FELT}{name}"] for name in self._felt.state()})
