"""Settings of CACLA+VAR; the defaults are the published model's (K17 II)."""

from dataclasses import dataclass
from typing import ClassVar

from lockstep import check_settings, setting


@dataclass(frozen=True)
class CaclaConfig:
    """Settings of critic, actor and exploration. Raises InputError for a value out of range."""

    turns_eyes: ClassVar[bool] = False

    discount: float = setting(0.3, "gamma, discount of the value one step ahead", least=0, below=1)
    critic_learning_rate: float = setting(0.75, "alpha, learning rate of the critic", least=0)
    critic_step_limit: float = setting(
        1.0,
        "limit of alpha |s|^2, the share of a TD error that one step removes; without a limit, as"
        " in K17, steps above 2 enlarge the error (D13)",
        above=0,
    )
    critic_initial_width: float = setting(
        0.0, "bound of the uniform initial weights of the critic; 0: 1 / n_state", least=0
    )
    n_hidden: int = setting(50, "number of hidden units of the actor", least=1)
    actor_learning_rate: float = setting(
        0.5,
        "initial learning rate of the actor, which falls to 0 at the end of training",
        least=0,
    )
    hidden_initial_width: float = setting(
        0.0,
        "bound of the uniform initial hidden weights of the actor; 0: 1 / (n_state n_hidden)",
        least=0,
    )
    output_initial_width: float = setting(
        0.01, "bound of the uniform initial output weights of the actor", least=0
    )
    weight_shrinkage: float = setting(
        1e-5,
        "shrinkage of the actor's hidden weights, per unit of learning rate and update",
        least=0,
    )
    exploration_variance: float = setting(1e-5, "variance of the noise on each action", least=0)
    copies_clipped_action: bool = setting(
        True,
        "whether the actor copies the change of activation after clipping at the limits (D14);"
        " otherwise the one before, as in K17",
    )

    def __post_init__(self) -> None:
        """Refuse values out of range."""
        check_settings(self)

    def check_fits(self, iterations_per_episode: int, n_visits: int) -> None:
        """Accept episodes of any length: each iteration is learned from by itself."""
