"""Settings of the agent; those of each learning rule are nested, under the rule's name."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from lockstep.command_space import (
    COMMAND_SPACES,
    HIGHEST_ACTIVATIONS,
    LOWEST_ACTIVATIONS,
    CommandSpace,
    activation_limits,
)
from lockstep.settings import check_settings, setting
from vergence_rl.cacla.config import CaclaConfig
from vergence_rl.gaze.config import GazeConfig
from vergence_rl.gaze.eye_turns import N_TURNS
from vergence_rl.hindsight.config import HindsightConfig
from vergence_rl.learning_rule import Task


@dataclass(frozen=True)
class VergenceRlConfig:
    """Settings of the agent; the defaults are the published model's (K17 II).

    Raises InputError for a value out of range, and for an episode or limits that do not fit.
    """

    seed: int = setting(1, "seed of the initial weights and of the exploration")
    learning_rule: str = setting(
        "cacla",
        "learning rule of the actor: cacla uses the TD error of a critic, as in K17; hindsight"
        " regresses on the best activations of each episode (D12)",
        choices=("cacla", "hindsight"),
    )
    n_training_iterations: int = setting(1_000_000, "training iterations of the run", least=1)
    iterations_per_episode: int = setting(10, "iterations of a training episode", least=1)
    n_features: int = setting(800, "number of features of both scales", least=1)
    feature_exponent: float = setting(
        1.0, "exponent that is applied to the features before they are normalised (D15)", above=0
    )
    state_entries: str = setting(
        "all",
        "entries of the state that the learner uses: all, features (what is seen), or activations"
        " (what is felt); the others are 0",
        choices=("all", "features", "activations"),
    )
    products_of_activations: bool = setting(
        False,
        "whether the products of two activations of one eye are entries of the state, too (D22)",
    )
    command_space: str = setting(
        "pair", "muscles that a command moves", choices=tuple(COMMAND_SPACES)
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
    state_standard_deviation: float = setting(
        0.02, "standard deviation to which each entry of the state is normalised", above=0
    )
    bias_input: float = setting(0.02, "constant last entry of the state", least=0)
    initial_squared_deviation: float = setting(
        0.0, "initial sum of squared deviations in the normaliser (D9)", least=0
    )
    initial_td_variance: float = setting(1.0, "initial running variance of the TD error", above=0)
    td_variance_rate: float = setting(
        0.001, "zeta of K17, rate of the running variance of the TD error", least=0, below=1
    )
    cacla: CaclaConfig = field(default_factory=CaclaConfig)
    hindsight: HindsightConfig = field(default_factory=HindsightConfig)
    gaze: GazeConfig = field(default_factory=GazeConfig)

    def __post_init__(self) -> None:
        """Refuse values out of range, and what the chosen rule cannot work with."""
        check_settings(self)
        activation_limits(self.space, self.lowest_activations, self.highest_activations)
        self.gaze.check_fits(self.iterations_per_episode, self.command_space, self.learning_rule)
        self.rule_config.check_fits(self.iterations_per_fixation, self.n_visits)

    @property
    def space(self) -> CommandSpace:
        """The command space that was chosen."""
        return COMMAND_SPACES[self.command_space]

    @property
    def rule_config(self) -> CaclaConfig | HindsightConfig:
        """The settings of the chosen rule."""
        chosen: CaclaConfig | HindsightConfig = getattr(self, self.learning_rule)
        return chosen

    @property
    def n_muscles(self) -> int:
        """Activations that are commanded."""
        return len(self.space.names)

    @property
    def n_products(self) -> int:
        """Products of two activations of one eye, squares included, among the state's entries."""
        n_of_eye = self.n_muscles // self.space.n_eyes
        return self.space.n_eyes * n_of_eye * (n_of_eye + 1) // 2 * self.products_of_activations

    @property
    def n_felt(self) -> int:
        """Entries of the state that the muscles give: the commanded activations and products."""
        return self.n_products + self.n_muscles

    @property
    def n_state(self) -> int:
        """Features, what is felt, and the bias."""
        return self.n_features + self.n_felt + 1

    @property
    def iterations_per_fixation(self) -> int:
        """Iterations of a fixation; without saccades an episode is one."""
        return self.gaze.fixation_iterations or self.iterations_per_episode

    @property
    def n_visits(self) -> int:
        """Iterations of one picture from which a rule learns: an episode, or of a fixation."""
        return self.iterations_per_fixation - self.gaze.n_before

    @property
    def limits(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Lowest and highest activation of each command, (n_muscles,)."""
        limits = activation_limits(self.space, self.lowest_activations, self.highest_activations)
        return np.array(limits.lowest), np.array(limits.highest)

    @property
    def task(self) -> Task:
        """What a rule must know; turns of the eyes have no limits."""
        lowest, highest = self.limits
        if self.gaze.learns_turns:
            lowest, highest = np.full(N_TURNS, -np.inf), np.full(N_TURNS, np.inf)
        return Task(
            self.seed,
            self.n_state,
            self.n_felt,
            lowest,
            highest,
            self.n_training_iterations,
            self.n_visits,
            self.initial_td_variance,
            self.td_variance_rate,
        )
