"""Settings of hindsight regression (D12, D16)."""

from dataclasses import dataclass

from lockstep.errors import InputError
from lockstep.settings import check_settings, setting


@dataclass(frozen=True)
class HindsightConfig:
    """Settings of regression and exploration. Raises InputError for a value out of range."""

    exploration_variance: float = setting(
        2.5e-4,
        "variance of the noise on each action until residuals are known, or throughout (D16)",
        least=0,
    )
    starts_share: float = setting(
        0.0,
        "share of the standard deviation of first activations that the first noise has, in their"
        " shape, in place of that variance; 0: it keeps the variance, alike for all muscles (D20)",
        least=0,
        most=1,
    )
    exploration_follows_residuals: bool = setting(
        True,
        "whether the noise takes the covariance of what the regression leaves, and commands come as"
        " near their limits as it measures; otherwise the noise stays as it began (D16)",
    )
    noise_narrows: tuple[float, ...] = setting(
        (1.0, 1.0),
        "shares of training from and to which the noise narrows to a tenth of its width (D20)",
        least=0,
        most=1,
        is_interval=True,
    )
    n_best: int = setting(
        1,
        "number of the best places of an episode whose mean, weighted by rank, is the target, and"
        " whose noise is tried again; 1: the best place alone (D20)",
        least=1,
    )
    target_scale: float = setting(
        0.005,
        "change of activation at which a target counts half in the regression",
        above=0,
    )
    ridge_share: float = setting(
        0.01,
        "penalty of the regression's weights, as a share of the mean square of a state's entry",
        above=0,
    )
    ridge_visits: float = setting(
        0.0,
        "number of visits, as a share of those remembered, that is added to that share (D20)",
        least=0,
    )
    memory_share: float = setting(
        0.5,
        "iterations after which the regression has forgotten all but 1 / e, as a share of those"
        " so far",
        above=0,
    )
    least_memory: float = setting(1000.0, "the least of these iterations", above=0)
    regression_period: int = setting(
        100,
        "iterations from one solution of the regression to the next, whole episodes",
        least=1,
    )

    def __post_init__(self) -> None:
        """Refuse values out of range."""
        check_settings(self)

    def check_fits(self, iterations_per_episode: int) -> None:
        """Raise InputError unless whole episodes of two iterations or more fit a period."""
        if iterations_per_episode < 2:
            raise InputError(
                "iterations_per_episode: expected 2 or more, whose rewards hindsight regression "
                f"compares, got {iterations_per_episode}"
            )
        if not self.n_best < iterations_per_episode:
            raise InputError(
                f"hindsight.n_best: expected less than {iterations_per_episode} (iterations per "
                f"episode), got {self.n_best}"
            )
        if self.regression_period % iterations_per_episode:
            raise InputError(
                f"hindsight.regression_period: expected a multiple of {iterations_per_episode} "
                f"(iterations per episode), got {self.regression_period}"
            )
