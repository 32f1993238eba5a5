"""Settings of the sparse coder."""

from dataclasses import dataclass, field

from lockstep import setting
from lockstep.optics import OpticsConfig, TurnNoiseConfig
from lockstep.task import TaskConfig


@dataclass(frozen=True)
class SparseCoderConfig(TaskConfig):
    """Settings of the sparse coder; the defaults are the published model's (K17 II).

    Raises InputError for a value out of range.
    """

    learning_rate: float = setting(0.2, "eta, learning rate of the dictionaries", least=0)
    final_learning_rate_share: float = setting(
        1.0,
        "final learning rate as a share of the first; it falls linearly (D17)",
        least=0,
    )
    resting_share: float = setting(
        1.0,
        "share of training after which the learning rate keeps its final value (D17)",
        above=0,
        most=1,
    )
    random_reward: bool = setting(
        False,
        "whether the reward is a random number, uniform in [-1, 0], that says nothing of images"
        " or energy: whatever is still learned does not come from the reward",
    )
    camera: OpticsConfig = field(default_factory=OpticsConfig)
    noise: TurnNoiseConfig = field(default_factory=TurnNoiseConfig)

    def __post_init__(self) -> None:
        """Refuse values out of range, and a task without training."""
        super().__post_init__()
        self.check_trains()
