"""Settings of the actor-critic."""

from dataclasses import dataclass

from lockstep.settings import check_settings, setting
from lockstep.topics import LATERAL_LIMITS, MEDIAL_LIMITS

N_MUSCLES = 2  # medial rectus, lateral rectus; the same command for both eyes (K17 II)
N_BIASES = 1
PAPER_EXPLORATION_VARIANCE = 1e-5  # K17 II; see exploration_step_exponent


@dataclass(frozen=True)
class VergenceRlConfig:
    """Settings of the actor-critic; the defaults are the published model's (K17 II).

    Raises InputError for a value out of range.
    """

    seed: int = setting(1, "seed of the initial weights and of the exploration")
    n_training_iterations: int = setting(
        1_000_000,
        "iterations after which the actor's learning rate has fallen to 0 and exploration to its"
        " final share",
        least=1,
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
        PAPER_EXPLORATION_VARIANCE,
        "variance of the noise on each muscle's action, as training begins",
        least=0,
    )
    wide_exploration_share: float = setting(
        0.0,
        "share of the training before the noise's standard deviation begins to fall (D16)",
        least=0,
        below=1,
    )
    final_exploration_share: float = setting(
        1.0,
        "share of the noise's standard deviation that is left as training ends; it falls"
        " exponentially (D16)",
        above=0,
    )
    exploration_step_exponent: float = setting(
        0.0,
        "k, where the actor's step is divided by (standard deviation of the noise / K17's)^k (D16)",
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

    def __post_init__(self) -> None:
        """Refuse values out of range."""
        check_settings(self)

    @property
    def n_state(self) -> int:
        """Features, the two activations and the bias."""
        return self.n_features + N_MUSCLES + N_BIASES
