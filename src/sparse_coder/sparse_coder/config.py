"""Settings of the sparse coder."""

from dataclasses import dataclass, field

from lockstep.command_space import COMMAND_SPACES, PAIR, CommandSpace
from lockstep.settings import check_settings, setting
from sparse_coder.gaze.config import GazeConfig

# Lambda of M_C unless another is given, 1/W, by the eyes' parameter set: energy is 20 % of the
# reward over the first 5,000 iterations on the generated stimuli, by which rule K17 chose its 0.035
# (D7). Measured, seed 1, by
#   run_experiment.sh --profile paper --model M_C --lambda-share 0.2
# and, for the second, with --set eye_plant.mechanics.parameter_set=anatomical.
# k17: mean E 0.3711, mean C 1.4300 W, lambda 0.0649; anatomical, of real muscle masses: mean E
# 0.4082, mean C 0.0858 W, lambda 1.190.
DEFAULT_METABOLIC_COST_WEIGHTS = {"k17": 0.065, "anatomical": 1.19}


@dataclass(frozen=True)
class SparseCoderConfig:
    """Settings of the sparse coder; the defaults are the published model's (K17 II).

    Raises InputError for a value out of range.
    """

    seed: int = setting(1, "seed of the initial dictionaries")
    n_training_iterations: int = setting(1_000_000, "training iterations of the run", least=1)
    n_bases: int = setting(400, "basis functions of each scale's dictionary", least=1)
    n_selections: int = setting(10, "matching pursuit's selections per patch", least=1)
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
    command_space: str = setting(
        PAIR,
        "muscles that a command moves and whose metabolic rate is charged",
        choices=tuple(COMMAND_SPACES),
    )
    metabolic_cost_weight: float = setting(
        0.0, "lambda of K17 eq. 5, price of energy in the reward; 0 in model M", "1/W", least=0
    )
    price_rise_share: float = setting(
        0.0,
        "share of training over which that price rises linearly from 0 (D21); 0: it is constant",
        least=0,
        most=1,
    )
    gaze: GazeConfig = field(default_factory=GazeConfig)

    def __post_init__(self) -> None:
        """Refuse values out of range."""
        check_settings(self)

    @property
    def space(self) -> CommandSpace:
        """The command space that was chosen."""
        return COMMAND_SPACES[self.command_space]
