"""Settings of the sparse coder."""

from dataclasses import dataclass, field

from lockstep import setting
from lockstep.optics import OpticsConfig
from lockstep.task import TaskConfig

# Lambda of M_C unless another is given, 1/W, by the eyes' parameter set: energy is 20 % of the
# reward over the first 5,000 iterations on the generated stimuli, by which rule K17 chose its 0.035
# (D7). Measured, seed 1, by
#   .venv/bin/python sweeps/lambda_share.py 0.2 --profile paper --model M_C
# and, for the second, with --set eyes.mechanics.parameter_set=anatomical.
# k17: mean E 0.3711, mean C 1.4300 W, lambda 0.0649; anatomical, of real muscle masses: mean E
# 0.4082, mean C 0.0858 W, lambda 1.190.
DEFAULT_METABOLIC_COST_WEIGHTS = {"k17": 0.065, "anatomical": 1.19}


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
        "whether the reward is a random number, uniform in [-1, 0], that says nothing of pictures"
        " or energy: what is learned nevertheless, the reward has not taught",
    )
    camera: OpticsConfig = field(default_factory=OpticsConfig)

    def __post_init__(self) -> None:
        """Refuse values out of range, and a task without training."""
        super().__post_init__()
        self.check_trains()
