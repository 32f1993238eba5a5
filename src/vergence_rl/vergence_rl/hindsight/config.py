"""Settings of hindsight regression (D12, D16)."""

from dataclasses import dataclass
from typing import ClassVar

from lockstep import InputError, check_settings, setting


@dataclass(frozen=True)
class HindsightConfig:
    """Settings of regression and exploration. Raises InputError for a value out of range."""

    turns_eyes: ClassVar[bool] = True

    exploration_variance: float = setting(
        2.5e-4,
        "initial variance of the noise on each action (D16)",
        least=0,
    )
    starts_share: float = setting(
        0.0,
        "initial noise as a share of the standard deviation of first activations, with their"
        " covariance; 0: exploration_variance, the same for all muscles (D20)",
        least=0,
        most=1,
    )
    exploration_follows_residuals: bool = setting(
        True,
        "whether the covariance of the residuals sets the noise and the commands at the limits;"
        " otherwise the noise keeps its initial variance (D16)",
    )
    least_noise_share: float = setting(
        0.0,
        "least SD of the noise, in any direction, as a share of that with which it begins (D22)",
        least=0,
        most=1,
    )
    n_best: int = setting(
        1,
        "number of the best places of an episode whose mean, weighted by rank, is the target, and"
        " whose noise is tried again; 1: the best place alone (D20)",
        least=1,
    )
    target_scale: float = setting(
        0.005,
        "change of activation at which a target has half its weight in the regression",
        above=0,
    )
    target_noise_scale: float = setting(
        0.0,
        "the same change in standard deviations of the noise, in whose shape lengths are measured;"
        " 0: target_scale (D22)",
        least=0,
    )
    ridge_share: float = setting(
        0.01,
        "ridge penalty as a share of the mean square of an entry of the state",
        above=0,
    )
    ridge_visits: float = setting(
        0.0,
        "ridge penalty of this many visits, added as a share of those remembered (D20)",
        least=0,
    )
    felt_ridge_share: float = setting(
        1.0,
        "ridge penalty on the weights of activations and the constant, as a share of that on the"
        " weights of features (D20)",
        above=0,
    )
    memory_share: float = setting(
        0.5,
        "visits after which one has 1 / e of its weight, as a share of all iterations so far",
        above=0,
    )
    least_memory: float = setting(1000.0, "least number of these visits", above=0)
    regression_period: int = setting(
        100,
        "iterations between two solutions of the regression; a multiple of an episode",
        least=1,
    )

    def __post_init__(self) -> None:
        """Refuse values out of range, and no noise where its shape is needed."""
        check_settings(self)
        if not self.exploration_variance and (self.least_noise_share or self.target_noise_scale):
            raise InputError(
                "exploration_variance: expected more than 0 with least_noise_share or "
                "target_noise_scale, which measure in its noise, got 0"
            )

    def check_fits(self, iterations_per_episode: int, n_visits: int) -> None:
        """Raise InputError unless whole episodes of two iterations or more fit a period.

        iterations_per_episode: or of a fixation; n_visits: those of them that a rule sees.
        """
        if iterations_per_episode < 2:
            raise InputError(
                "iterations_per_episode: expected 2 or more, whose rewards hindsight regression "
                f"compares, got {iterations_per_episode}"
            )
        if not self.n_best < n_visits:
            raise InputError(
                f"hindsight.n_best: expected less than {n_visits} (iterations of vergence in a "
                f"row), got {self.n_best}"
            )
        if self.regression_period % iterations_per_episode:
            raise InputError(
                f"hindsight.regression_period: expected a multiple of {iterations_per_episode} "
                f"(iterations per episode), got {self.regression_period}"
            )
