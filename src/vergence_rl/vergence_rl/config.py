"""Settings of the agent; those of each learning rule are nested, under the rule's name."""

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from lockstep import InputError, build, setting
from lockstep.task import TaskConfig
from lockstep.wire.topics import N_SACCADES
from lockstep.written.yaml_text import load_yaml
from vergence_rl.focusing import LensConfig, focusing_iterations
from vergence_rl.gaze.config import GazeConfig
from vergence_rl.gaze.eye_turns import N_TURNS
from vergence_rl.hindsight.config import HindsightConfig
from vergence_rl.learning_rule import RuleConfig, Task
from vergence_rl.rules import RULES, RuleSettings, rule_of

# Vergence learns from what follows the saccades.
LEAST_FIXATION = N_SACCADES + 2
# Of a lens, whose rewards are compared.
_LEAST_TRIES = 2


@dataclass(frozen=True)
class VergenceRlConfig(RuleSettings, TaskConfig):
    """Settings of the agent; the defaults are the published model's (K17 II).

    Raises InputError for a value out of range, and for an episode or limits that do not fit.
    """

    learning_rule: str = setting(
        "cacla",
        "learning rule of the actor: cacla uses the TD error of a critic, as in K17; hindsight"
        " regresses on the best activations of each episode (D12); FILE.py:CLASS or MODULE:CLASS is"
        " a rule of one's own",
    )
    own_rule: str = setting("", "settings of a rule of one's own, as YAML or JSON")
    feature_exponent: float = setting(
        1.0, "exponent that is applied to the features before they are normalised (D15)", above=0
    )
    state_entries: str = setting(
        "all",
        "entries of the state that the learner uses: all, features (visual) or activations"
        " (proprioceptive); the others are 0",
        choices=("all", "features", "activations"),
    )
    products_of_activations: bool = setting(
        False,
        "whether the products of two activations that turn one eye are entries of the state, too"
        " (D22)",
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
    lens: LensConfig = field(default_factory=LensConfig)

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
                "measures_turns: its actions are changes of activation, not rotations of the eyes"
            )
        n_focusing = focusing_iterations(self.n_visits) if self.n_lenses else 0
        self.rule_config.check_fits(self.iterations_per_fixation, self.n_visits - n_focusing)
        if self.n_lenses:
            self._check_lenses()

    def _check_lenses(self) -> None:
        """Refuse episodes that are too short to try each lens, and turns of the eyes."""
        if self.n_tries < _LEAST_TRIES:
            raise InputError(
                f"iterations_per_episode: expected {2 * _LEAST_TRIES * self.n_lenses} or more with "
                f"command_space {self.command_space}, got {self.iterations_per_episode}"
            )
        self.lens_config.check_fits(self.iterations_per_episode, self.n_tries)
        if self.learns_turns:
            raise InputError(
                "command_space: expected one without lenses with saccades or measures_turns, got "
                f"{self.command_space}"
            )

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
        chosen: RuleConfig
        if self.learning_rule not in RULES:
            chosen = _own(rule_of(self.learning_rule).settings, self.own_rule)
        elif self.own_rule:
            raise InputError(
                f"own_rule: expected none with {self.learning_rule}, got {self.own_rule!r}"
            )
        else:
            chosen = getattr(self, self.learning_rule)
        return chosen

    @property
    def n_muscles(self) -> int:
        """Activations that are commanded."""
        return len(self.space.names)

    @property
    def n_products(self) -> int:
        """Products of two activations of one eye, squares included, among the state's entries."""
        n_eyes = self.space.turning.n_eyes
        n_of_eye = len(self.space.turning.names) // n_eyes
        return n_eyes * n_of_eye * (n_of_eye + 1) // 2 * self.products_of_activations

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
        return self.iterations_per_fixation - self.n_before - self.n_tries * self.n_lenses

    @property
    def lens_config(self) -> HindsightConfig:
        """The settings of a lens's rule."""
        return self.lens.rule_config(self.hindsight)

    @property
    def lens_tasks(self) -> tuple[Task, ...]:
        """What the rule of each lens must know, of one command that is cut at its limits."""
        no_limit = np.array([np.inf])
        task = replace(
            self.task,
            n_state=self.n_state - self.scales.n_for_eyes * self.n_bases,
            lowest=-no_limit,
            highest=no_limit,
            iterations_per_episode=self.n_tries,
        )
        return (task,) * self.n_lenses

    @property
    def eyes_task(self) -> Task:
        """What the rule of the eyes must know."""
        return replace(self.task, n_state=self.n_state - self.scales.n_for_lenses * self.n_bases)

    @property
    def limit_arrays(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Lowest and highest activation of each command, (n_muscles,)."""
        return np.array(self.limits.lowest), np.array(self.limits.highest)

    @property
    def task(self) -> Task:
        """What a rule must know that is told of all; turns of the eyes have no limits."""
        limits = self.turning_limits
        lowest, highest = np.array(limits.lowest), np.array(limits.highest)
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


def _own(config_class: type[RuleConfig], text: str) -> RuleConfig:
    """Return the settings of a rule of one's own; InputError for a text that has others."""
    try:
        values = load_yaml(text) if text else {}
        if not isinstance(values, dict):
            raise InputError(f"expected {{NAME: VALUE}}, got {text!r}")
        return build(config_class, values)
    except InputError as error:
        raise InputError(f"own_rule: {error}") from error
