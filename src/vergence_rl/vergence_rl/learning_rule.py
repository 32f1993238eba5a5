"""What a learning rule has to do for the agent, whichever rule it is."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Moment:
    """One observation as a rule sees it.

    iteration: within the episode, from 0; training_iteration: training iterations before this one;
    state: s, (n_state,); activations: x, (n_muscles,); reward: r_t, of now.
    """

    iteration: int
    training_iteration: int
    state: NDArray[np.float64]
    activations: NDArray[np.float64]
    reward: float

    def follows(self, other: "Moment") -> bool:
        """Whether this is the next iteration of the same training episode."""
        steps = (
            self.iteration - other.iteration,
            self.training_iteration - other.training_iteration,
        )
        return steps == (1, 1)


@dataclass(frozen=True)
class Opinion:
    """What a rule reports of a moment; each rule says what it means by it."""

    value: float
    td_error: float
    td_variance: float
    actor_learning_rate: float
    critic_learning_rate: float


class LearningRule(Protocol):
    """Learns which changes of activation lead to reward."""

    learning_steps: int

    def learn(self, moment: Moment) -> Opinion:
        """Learn from a moment of training."""

    def judge(self, moment: Moment) -> Opinion:
        """Say the same of a moment of a test, and learn nothing, from the next one either."""

    def action(self, state: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the change of activations in a state, (n_muscles,), without exploration."""

    def noise(self, draw: np.random.Generator) -> NDArray[np.float64]:
        """Return the exploration to add to an action, (n_muscles,)."""

    def command(self, wanted: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the activations within their limits that come nearest those wanted."""

    def acted(
        self, moment: Moment, action: NDArray[np.float64], command: NDArray[np.float64]
    ) -> None:
        """Note the action with its noise, and the command, that answered a moment of training."""

    def state(self) -> dict[str, NDArray[Any]]:
        """Return all that learning has changed, as copies."""

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Continue from what state returned, with the next episode."""
