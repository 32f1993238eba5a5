"""Settings of the agent; those of each learning rule are nested, under the rule's name."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from lockstep import InputError, setting
from lockstep.task import TaskConfig
from lockstep.wire.topics import N_SACCADES
from vergence_rl.gaze.config import GazeConfig
from vergence_rl.gaze.eye_turns import N_TURNS
from vergence_rl.learning_rule import RuleConfig, Task
from vergence_rl.rules import RULES, RuleSettings

# Vergence learns from what follows the saccades.
LEAST_FIXATION = N_SACCADES + 2


@dataclass(frozen=True)
class VergenceRlConfig(RuleSettings, TaskConfig):
    """Settings of the agent; the defaults are the published model's (K17 II).

    Raises InputError for a value out of range, and for an episode or limits that do not fit.
    """

    learning_rule: str = setting(
        "cacla",
        "learning rule of the actor: cacla uses the TD error of a critic, as in K17; hindsight"
        " regresses on the best activations of each episode (D12)",
        choices=tuple(RULES),
    )
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
    gaze: GazeConfig = field(default_factory=GazeConfig)

    def __post_init__(self) -> None:
        """Refuse values out of range, and what the chosen rule cannot work with."""
        super().__post_init__()
        self.check_trains()
        if 0 < self.fixation_iterations < LEAST_FIXATION:
            raise InputError(
                f"fixation_iterations: expected 0, or {LEAST_FIXATION} or more, of which "
                f"{N_SACCADES} are saccades, got {self.fixation_iterations}"
            )
        if self.learns_turns and not self.rule_config.turns_eyes:
            raise InputError(
                f"learning_rule: expected another one than {self.learning_rule} with saccades or "
                "measures_turns: its actions are changes of activation and not turns of the eyes"
            )
        self.rule_config.check_fits(self.iterations_per_fixation, self.n_visits)

    @property
    def n_features(self) -> int:
        """Features of all scales."""
        return len(self.scales.all) * self.n_bases

    @property
    def n_before(self) -> int:
        """Iterations of a fixation or an episode before vergence learns from what it does."""
        return N_SACCADES if self.fixation_iterations else int(self.measures_turns)

    @property
    def rule_config(self) -> RuleConfig:
        """The settings of the chosen rule."""
        chosen: RuleConfig = getattr(self, self.learning_rule)
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
        return self.fixation_iterations or self.iterations_per_episode

    @property
    def n_visits(self) -> int:
        """Iterations of one picture from which a rule learns: an episode, or of a fixation."""
        return self.iterations_per_fixation - self.n_before

    @property
    def limit_arrays(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Lowest and highest activation of each command, (n_muscles,)."""
        return np.array(self.limits.lowest), np.array(self.limits.highest)

    @property
    def task(self) -> Task:
        """What a rule must know; turns of the eyes have no limits."""
        lowest, highest = self.limit_arrays
        if self.learns_turns:
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
