"""What all nodes must agree on: declared once, given once, and part of each node's configuration.

In a parameter file the task stands under `/**/*`, so it reaches every node.
"""

import math
from dataclasses import dataclass, field

from lockstep.command_space import (
    ALL_MUSCLES,
    COMMAND_SPACES,
    HIGHEST_ACTIVATIONS,
    LOWEST_ACTIVATIONS,
    PAIR,
    CommandSpace,
    Limits,
    activation_limits,
)
from lockstep.errors import InputError
from lockstep.scales import ScalesConfig
from lockstep.settings import check_settings, setting

# K17: whose reward does not count energy, and does.
MODELS = ("M", "M_C")

# Lambda of M_C unless another is given, 1/W, by the eyes' parameter set: energy is 20 % of the
# reward over the first 5,000 iterations on the generated stimuli, by which rule K17 chose its 0.035
# (D7). Measured, seed 1, by
#   .venv/bin/python sweeps/lambda_share.py 0.2 --profile paper --model M_C
# and, for the second, with --set eyes.mechanics.parameter_set=anatomical.
# k17: mean E 0.3711, mean C 1.4300 W, lambda 0.0649; anatomical, of real muscle masses: mean E
# 0.4082, mean C 0.0858 W, lambda 1.190.
DEFAULT_METABOLIC_COST_WEIGHTS = {"k17": 0.065, "anatomical": 1.19}


@dataclass(frozen=True)
class TaskConfig:
    """The task of a run; defaults are the paper's. Raises InputError for values out of range."""

    seed: int = setting(1, "seed of dictionaries, weights, exploration, episodes and trials")
    n_training_iterations: int = setting(1_000_000, "training iterations of the run", least=0)
    iterations_per_episode: int = setting(10, "iterations of a training episode", least=1)
    iterations_per_trial: int = setting(20, "iterations of a test trial", least=1)
    fixation_iterations: int = setting(
        0,
        "iterations of a fixation, which begins with two saccades to the gaze target; 0: the eyes"
        " make no saccades (D22)",
        least=0,
    )
    measures_turns: bool = setting(
        False,
        "whether rotations of both eyes are measured without saccades, too, so that vergence can be"
        " learned as rotations (D23)",
    )
    command_space: str = setting(
        PAIR,
        "muscles that a command moves and whose metabolic rate counts, or joints of a robot's head",
        choices=tuple(COMMAND_SPACES),
    )
    lowest_activations: tuple[float, ...] = setting(
        LOWEST_ACTIVATIONS,
        "lowest activation of each command, or one for all",
        least=0,
        most=1,
    )
    highest_activations: tuple[float, ...] = setting(
        HIGHEST_ACTIVATIONS,
        "highest activation of each command, or one for all",
        least=0,
        most=1,
    )
    n_bases: int = setting(400, "basis functions of each scale's dictionary", least=1)
    n_selections: int = setting(10, "matching pursuit's selections per patch", least=1)
    metabolic_cost_weight: float = setting(
        0.0, "lambda of K17 eq. 5, what a watt takes from the reward; 0 in model M", "1/W", least=0
    )
    price_rise_share: float = setting(
        0.0,
        "share of training over which lambda rises linearly from 0 (D21); 0: it is constant",
        least=0,
        most=1,
    )
    scales: ScalesConfig = field(default_factory=ScalesConfig)
    schedule: str = setting(
        "",
        "changes of the eyes during the run, as YAML or JSON:"
        " [{at: ITERATION, set: {eyes.PARAMETER: value}}]; empty: none",
    )

    def __post_init__(self) -> None:
        """Refuse values out of range, and impossible combinations."""
        check_settings(self)
        activation_limits(self.space, self.lowest_activations, self.highest_activations)
        if self.n_training_iterations % self.iterations_per_episode:
            raise InputError(
                f"n_training_iterations: expected a multiple of {self.iterations_per_episode} "
                f"(iterations per episode), got {self.n_training_iterations}"
            )
        if self.fixation_iterations and self.measures_turns:
            raise InputError(
                "measures_turns: expected false with saccades, whose rotations are measured anyway"
            )
        if self.space.of_joints and self.metabolic_cost_weight:
            raise InputError(
                f"metabolic_cost_weight: expected 0 with command_space {self.command_space}, whose "
                f"joints have no metabolic rate, got {self.metabolic_cost_weight}"
            )
        if self.space.of_joints and self.scales.apart:
            raise InputError(
                f"scales.zoom: expected 1 with command_space {self.command_space}, whose cameras "
                f"take one picture each, got {list(self.scales.zoom)}"
            )
        if bool(self.n_lenses) != bool(self.scales.n_for_lenses):
            raise InputError(
                f"scales.n_for_lenses: expected {'1 or more' if self.n_lenses else '0'} with "
                f"command_space {self.command_space}, got {self.scales.n_for_lenses}"
            )
        self._check_turning()

    def check_trains(self) -> None:
        """Raise InputError for a task without training, over which no rate can fall."""
        if not self.n_training_iterations:
            raise InputError("n_training_iterations: expected 1 or more, got 0")

    def _check_turning(self) -> None:
        """Refuse saccades of eyes that cannot make them, and fixations that are cut off."""
        if not self.learns_turns:
            return
        name, none = (
            ("measures_turns", "false") if self.measures_turns else ("fixation_iterations", "0")
        )
        if self.turning_space != ALL_MUSCLES:
            raise InputError(
                f"{name}: expected {none} with command_space {self.command_space}, since each eye "
                f"is turned about all axes, got {getattr(self, name)}"
            )
        for length in ("iterations_per_episode", "iterations_per_trial"):
            if self.fixation_iterations and getattr(self, length) % self.fixation_iterations:
                raise InputError(
                    f"{length}: expected a multiple of {self.fixation_iterations} "
                    f"(fixation_iterations), got {getattr(self, length)}"
                )

    @property
    def learns_turns(self) -> bool:
        """Whether vergence is learned as turns of the eyes: with saccades, or measures_turns."""
        return self.fixation_iterations > 0 or self.measures_turns

    @property
    def space(self) -> CommandSpace:
        """The command space that was chosen."""
        return COMMAND_SPACES[self.command_space]

    @property
    def turning_space(self) -> str:
        """Name of the command space of what turns the eyes alone, without lenses."""
        return next(name for name, space in COMMAND_SPACES.items() if space == self.space.turning)

    @property
    def n_lenses(self) -> int:
        """Commands that focus lenses."""
        return len(self.space.names) - len(self.space.turning.names)

    @property
    def n_tries(self) -> int:
        """Iterations of an episode in which each lens tries: lenses share its second half."""
        return self.iterations_per_episode // 2 // self.n_lenses if self.n_lenses else 0

    @property
    def n_verging(self) -> float:
        """Iterations of an episode, the first ones, in which the eyes try: without lenses all."""
        n_focusing = self.n_tries * self.n_lenses
        return self.iterations_per_episode - n_focusing if n_focusing else math.inf

    @property
    def limits(self) -> Limits:
        """Of the activation of each command."""
        return activation_limits(self.space, self.lowest_activations, self.highest_activations)

    @property
    def turning_limits(self) -> Limits:
        """Of the activation of each command that turns the eyes."""
        n, limits = len(self.space.turning.names), self.limits
        return Limits(limits.lowest[:n], limits.highest[:n])
