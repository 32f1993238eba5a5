"""Settings of CACLA+VAR; the defaults are the published model's (K17 II)."""

from dataclasses import dataclass

from lockstep.settings import check_settings, setting


@dataclass(frozen=True)
class CaclaConfig:
    """Settings of critic, actor and exploration. Raises InputError for a value out of range."""

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
    actor_learning_rate: float = setting(
        0.5,
        "initial learning rate of the actor, which falls to 0 at the end of training",
        least=0,
    )
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
        1e-5, "variance of the noise on each action, throughout", least=0
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

    def check_fits(self, iterations_per_episode: int) -> None:
        """Accept episodes of any length: each iteration is learned from by itself."""
