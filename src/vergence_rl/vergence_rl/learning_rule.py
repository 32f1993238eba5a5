"""What a learning rule is to the agent, whichever rule it is.

A rule of one's own is a file with its settings (RuleConfig) and the rule (LearningRule), which
has the class of its settings as `settings`; docs/examples/reinforce.py is one.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

NO_TARGET_DEG, NO_TURNS_DEG = np.full(2, np.nan), np.full((2, 3), np.nan)


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
        """Entries of a command: activations, or turns of the eyes."""
        return len(self.lowest)


@dataclass(frozen=True)
class TimeStep:
    """One observation as a rule sees it.

    iteration: within the episode, from 0; training_iteration: training iterations before this one;
    state: s, (n_state,); activations: x, (n_muscles,) those that are commanded; reward: r_t, of
    now. What turns of the eyes need: target_deg (2,) and turns_deg (2, 3), as Agent.observe takes
    them; energy_penalty: lambda C; leading_eye: 0 the left one, 1 the right one. is_binocular:
    whether both eyes see something; is_compared: whether the reward is one of those that the
    episode's places are compared by.
    """

    iteration: int
    training_iteration: int
    state: Floats
    activations: Floats
    reward: float
    target_deg: Floats = field(default_factory=lambda: NO_TARGET_DEG)
    turns_deg: Floats = field(default_factory=lambda: NO_TURNS_DEG)
    energy_penalty: float = 0.0
    leading_eye: int = 0
    is_binocular: bool = True
    is_compared: bool = True

    def follows(self, other: "TimeStep") -> bool:
        """Whether this is the next iteration of the same training episode."""
        steps = (
            self.iteration - other.iteration,
            self.training_iteration - other.training_iteration,
        )
        return steps == (1, 1)


@dataclass(frozen=True)
class Decision:
    """The answer to one observation.

    command: (n_muscles,) target activations within their limits; action: (n_muscles,) chosen change
    of activation, exploration included, before the limits; where the eyes are turned, the change
    that is commanded. The other numbers are what the rule reports of itself; each rule says what it
    means by them. td_error is NaN where there is nothing to learn from.
    """

    command: Floats
    action: Floats
    value: float
    td_error: float
    td_variance: float
    actor_learning_rate: float
    critic_learning_rate: float


class RuleConfig(Protocol):
    """Settings of a rule: a frozen dataclass whose fields are made by lockstep.settings.setting.

    turns_eyes: whether the rule's actions may be turns of the eyes in place of changes of
    activation (D22, D23).
    """

    turns_eyes: ClassVar[bool]

    def check_fits(self, iterations_per_episode: int, n_visits: int) -> None:
        """Raise InputError for episodes from which the rule cannot learn.

        iterations_per_episode: or of a fixation; n_visits: those of them that the rule sees.
        """


class LearningRule(Protocol):
    """Learns which changes of activation, or turns of the eyes, lead to reward.

    Made from its settings and a Task.
    """

    def step(
        self, observation: TimeStep, *, learning: bool, draw: np.random.Generator | None
    ) -> Decision:
        """Answer an observation.

        learning: learn first from the episode so far, and later from this answer; without it
        nothing is learned from either. draw: the source of exploration, None for none.
        """

    def state(self) -> dict[str, NDArray[Any]]:
        """Return all that learning has changed, as copies."""

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Continue from what state returned, with the next episode."""


def td_variance(variance_tm1: float, delta_t: float, rate: float) -> float:
    """Return the running variance (1 - rate) var_tm1 + rate delta_t^2 (K17 II, rate = zeta)."""
    return (1.0 - rate) * variance_tm1 + rate * delta_t**2
