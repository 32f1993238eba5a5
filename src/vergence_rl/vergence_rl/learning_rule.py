"""What a learning rule is to the agent, whichever rule it is.

A third rule is a configuration and a rule in a folder of their own. The rule goes into the table
of `agent.py`, its configuration becomes a field of `VergenceRlConfig`, both under the rule's name.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Task:
    """What a rule must know of the agent that it serves.

    n_felt: entries of the state from the muscles, its last ones except the constant; lowest,
    highest: (n_muscles,) limits of what is commanded: activations or, where vergence is learned as
    turns, those of the eyes in degrees; iterations_per_episode: of those that the rule sees.
    """

    seed: int
    n_state: int
    n_felt: int
    lowest: Floats
    highest: Floats
    n_training_iterations: int
    iterations_per_episode: int
    initial_td_variance: float
    td_variance_rate: float

    @property
    def n_muscles(self) -> int:
        """Activations that are commanded."""
        return len(self.lowest)


@dataclass(frozen=True)
class Observation:
    """One observation as a rule sees it.

    iteration: within the episode, from 0; training_iteration: training iterations before this one;
    state: s, (n_state,); activations: x, (n_muscles,) those that are commanded; reward: r_t, of
    now.
    """

    iteration: int
    training_iteration: int
    state: Floats
    activations: Floats
    reward: float

    def follows(self, other: "Observation") -> bool:
        """Whether this is the next iteration of the same training episode."""
        steps = (
            self.iteration - other.iteration,
            self.training_iteration - other.training_iteration,
        )
        return steps == (1, 1)


@dataclass(frozen=True)
class Decision:
    """The answer to one observation.

    command: (n_muscles,) target activations within their limits; action: (n_muscles,) change of
    activation, exploration included, before the limits. The other numbers are what the rule
    reports of itself; each rule says what it means by them. td_error is NaN where there is nothing
    to learn from.
    """

    command: Floats
    action: Floats
    value: float
    td_error: float
    td_variance: float
    actor_learning_rate: float
    critic_learning_rate: float


class LearningRule(Protocol):
    """Learns which changes of activation lead to reward."""

    learning_steps: int

    def step(
        self, observation: Observation, *, learning: bool, draw: np.random.Generator | None
    ) -> Decision:
        """Answer an observation.

        learning: learn first from the episode so far, and later from this answer; without it
        nothing is learned from either. draw: the source of exploration, None for none.
        """

    def state(self) -> dict[str, NDArray[Any]]:
        """Return all that learning has changed, as copies."""

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Continue from what state returned, with the next episode."""
