"""Settings of the agent and its learning rules."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lockstep.errors import InputError
from lockstep.settings import check_settings, setting
from lockstep.wire.topics import LATERAL_LIMITS, MEDIAL_LIMITS

N_MUSCLES = 2  # medial rectus, lateral rectus; the same command for both eyes (K17 II)
N_BIASES = 1


@dataclass(frozen=True)
class VergenceRlConfig:
    """Settings of the agent; the defaults are the published model's (K17 II).

    Raises InputError for a value out of range.
    """

    seed: int = setting(1, "seed of the initial weights and of the exploration")
    learning_rule: str = setting(
        "cacla",
        "how the actor learns: cacla from the TD error of a critic, as in K17; hindsight from the"
        " best place of each episode, by regression (D12)",
        choices=("cacla", "hindsight"),
    )
    n_training_iterations: int = setting(
        1_000_000,
        "iterations after which the actor's learning rate has fallen to 0 (cacla)",
        least=1,
    )
    iterations_per_episode: int = setting(
        10, "iterations of an episode, whose places are compared (hindsight)", least=2
    )
    n_features: int = setting(800, "features of both scales together", least=1)
    feature_exponent: float = setting(
        1.0, "power to which features are raised before they are normalised (D15)", above=0
    )
    medial_limits: tuple[float, ...] = setting(
        MEDIAL_LIMITS, "limits of the medial rectus' activation", least=0, most=1, is_interval=True
    )
    lateral_limits: tuple[float, ...] = setting(
        LATERAL_LIMITS,
        "limits of the lateral rectus' activation",
        least=0,
        most=1,
        is_interval=True,
    )
    state_standard_deviation: float = setting(
        0.02, "standard deviation to which each entry of the state is normalised", above=0
    )
    bias_input: float = setting(0.02, "the state's last, constant entry", least=0)
    initial_squared_deviation: float = setting(
        0.0, "where the normaliser's sum of squared deviations from the mean starts (D9)", least=0
    )
    discount: float = setting(0.3, "gamma, discount of the value one step ahead", least=0, below=1)
    critic_learning_rate: float = setting(0.75, "alpha, learning rate of the critic", least=0)
    critic_step_limit: float = setting(
        1.0,
        "limit of alpha |s|^2, the share of a TD error that one step takes away: without, as in"
        " K17, the critic diverges at a picture whose features lie far out (D13)",
        above=0,
    )
    critic_initial_width: float = setting(
        0.0, "the critic's weights start uniform in +- this; 0 means 1 / n_state", least=0
    )
    n_hidden: int = setting(50, "hidden units of the actor", least=1)
    actor_learning_rate: float = setting(0.5, "initial learning rate of the actor", least=0)
    hidden_initial_width: float = setting(
        0.0,
        "the actor's hidden weights start uniform in +- this; 0 means 1 / (n_state n_hidden)",
        least=0,
    )
    output_initial_width: float = setting(
        0.01, "the actor's output weights start uniform in +- this", least=0
    )
    weight_shrinkage: float = setting(
        1e-5,
        "shrinkage of the actor's hidden weights, per unit of learning rate and update",
        least=0,
    )
    exploration_variance: float = setting(
        1e-5,
        "variance of the noise on each muscle's action: throughout (cacla), or until residuals are"
        " known (hindsight, D16)",
        least=0,
    )
    initial_td_variance: float = setting(
        1.0, "where the running variance of the TD error starts", above=0
    )
    td_variance_rate: float = setting(
        0.001, "zeta of K17, rate of the running variance of the TD error", least=0, below=1
    )
    copies_clipped_action: bool = setting(
        True,
        "whether the actor copies the change of activation that the limits have left (D14), not the"
        " one before clipping, as in K17; there a muscle at its limit learns nothing more, since"
        " whatever is tried beyond it has no effect",
    )
    exploration_follows_residuals: bool = setting(
        True,
        "whether the noise takes the covariance of what the regression leaves, and commands come as"
        " near their limits as it measures; otherwise the noise stays as it began (hindsight, D16)",
    )
    target_scale: float = setting(
        0.005,
        "change of activation at which a target counts half in the regression (hindsight, D12)",
        above=0,
    )
    ridge_share: float = setting(
        0.01,
        "penalty of the regression's weights, as a share of the mean square of a state's entry"
        " (hindsight, D12)",
        above=0,
    )
    memory_share: float = setting(
        0.5,
        "iterations after which the regression has forgotten all but 1 / e, as a share of those"
        " so far (hindsight, D12)",
        above=0,
    )
    least_memory: float = setting(1000.0, "the least of these iterations (hindsight, D12)", above=0)
    regression_period: int = setting(
        100,
        "iterations from one solution of the regression to the next, whole episodes"
        " (hindsight, D12)",
        least=1,
    )

    def __post_init__(self) -> None:
        """Refuse values out of range."""
        check_settings(self)
        if self.regression_period % self.iterations_per_episode:
            raise InputError(
                f"regression_period: expected a multiple of {self.iterations_per_episode} "
                f"(iterations per episode), got {self.regression_period}"
            )

    @property
    def n_state(self) -> int:
        """Features, the two activations and the bias."""
        return self.n_features + N_MUSCLES + N_BIASES

    @property
    def limits(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The lowest and the highest activations, (n_muscles,) each."""
        lowest, highest = np.array([self.medial_limits, self.lateral_limits]).T
        return lowest, highest
