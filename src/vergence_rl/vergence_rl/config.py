"""Settings of the actor-critic."""

import math
from dataclasses import dataclass

from lockstep.errors import InputError

N_MUSCLES = 2  # medial rectus, lateral rectus; the same command for both eyes (K17 II)
N_BIASES = 1

_POSITIVE = ("state_standard_deviation", "initial_td_variance", "critic_step_limit")
_NOT_NEGATIVE = (
    "bias_input",
    "initial_squared_deviation",
    "critic_learning_rate",
    "critic_initial_width",
    "actor_learning_rate",
    "hidden_initial_width",
    "output_initial_width",
    "weight_shrinkage",
    "exploration_variance",
)
_FRACTIONS = ("discount", "td_variance_rate")


@dataclass(frozen=True)
class VergenceRlConfig:
    """Settings of the actor-critic; the defaults are the published model's (K17 II).

    seed: of the initial weights and the exploration; n_training_iterations: after as many, the
    actor's learning rate has fallen to 0; n_features: of both scales together.

    State: each entry is normalised to state_standard_deviation; initial_squared_deviation is what
    the sum of squared deviations from the mean starts at; bias_input is the last, constant entry.

    Initial weights are uniform in +-width; a width of 0 for the critic means 1/n_state, for the
    actor's hidden layer 1/(n_state n_hidden).

    weight_shrinkage: of the hidden layer's input weights, per unit of learning rate and update;
    critic_step_limit: of alpha |s|^2, the share of a TD error that one step takes away; without,
    as in K17, the critic diverges at a picture whose features lie far out.
    exploration_variance: of the noise on each muscle's action; td_variance_rate: zeta of K17.
    copies_clipped_action: whether what the actor copies is the change of activation that the limits
    have left, in place of the one before clipping, as in K17. There a muscle at its limit learns
    nothing any more: whatever is tried beyond it has no effect.
    Raises InputError for a value out of range.
    """

    seed: int = 1
    n_training_iterations: int = 1_000_000
    n_features: int = 800
    medial_limits: tuple[float, ...] = (0.0, 0.2)
    lateral_limits: tuple[float, ...] = (0.0, 0.1)
    state_standard_deviation: float = 0.02
    bias_input: float = 0.02
    initial_squared_deviation: float = 0.0
    discount: float = 0.3
    critic_learning_rate: float = 0.75
    critic_step_limit: float = 1.0
    critic_initial_width: float = 0.0
    n_hidden: int = 50
    actor_learning_rate: float = 0.5
    hidden_initial_width: float = 0.0
    output_initial_width: float = 0.01
    weight_shrinkage: float = 1e-5
    exploration_variance: float = 1e-5
    initial_td_variance: float = 1.0
    td_variance_rate: float = 0.001
    copies_clipped_action: bool = False

    def __post_init__(self) -> None:
        """Refuse what no run can mean."""
        for name in ("n_training_iterations", "n_features", "n_hidden"):
            if getattr(self, name) < 1:
                raise InputError(f"{name}: expected 1 or more, got {getattr(self, name)}")
        for name in _POSITIVE:
            if not 0.0 < getattr(self, name) < math.inf:
                raise InputError(f"{name}: expected more than 0, got {getattr(self, name)}")
        for name in _NOT_NEGATIVE:
            if not 0.0 <= getattr(self, name) < math.inf:
                raise InputError(f"{name}: expected 0 or more, got {getattr(self, name)}")
        for name in _FRACTIONS:
            if not 0.0 <= getattr(self, name) < 1.0:
                raise InputError(f"{name}: expected [0, 1), got {getattr(self, name)}")
        for name in ("medial_limits", "lateral_limits"):
            _check_limits(name, getattr(self, name))

    @property
    def n_state(self) -> int:
        """Features, the two activations and the bias."""
        return self.n_features + N_MUSCLES + N_BIASES


def _check_limits(name: str, limits: tuple[float, ...]) -> None:
    if len(limits) != 2 or not 0.0 <= limits[0] < limits[1] <= 1.0:
        raise InputError(
            f"{name}: expected two activations, low below high, in [0, 1], got {limits}"
        )
