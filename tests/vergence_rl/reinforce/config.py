"""Settings of REINFORCE."""

from dataclasses import dataclass
from typing import ClassVar

from lockstep import check_settings, setting


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
