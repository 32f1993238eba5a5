"""Settings of gaze."""

from dataclasses import dataclass

from lockstep.command_space import ALL_MUSCLES
from lockstep.errors import InputError
from lockstep.settings import check_settings, setting
from lockstep.wire.topics import N_SACCADES

# Vergence learns from what follows the saccades.
_LEAST_FIXATION = N_SACCADES + 2


@dataclass(frozen=True)
class GazeConfig:
    """Settings of saccades; raises InputError for a value out of range."""

    fixation_iterations: int = setting(
        0,
        "iterations of a fixation, which begins with two saccades to the gaze target; 0: the eyes"
        " make no saccades (D22)",
        least=0,
    )
    measures_turns: bool = setting(
        False,
        "whether vergence is learned as turns of the eyes without saccades, too (D23)",
    )
    saccade_noise: float = setting(
        0.0015,
        "standard deviation of the noise on each activation of the first saccade, or the first"
        " command of an episode without saccades, in training; how activations turn the eyes is"
        " learned from it (D22)",
        least=0,
    )
    memory_share: float = setting(
        0.0,
        "movements after which one has 1 / e of its weight in what is known of how activations turn"
        " an eye, as a share of all so far; 0: all have the same weight (D22)",
        least=0,
    )

    def __post_init__(self) -> None:
        """Refuse values out of range."""
        check_settings(self)
        if self.fixation_iterations and self.measures_turns:
            raise InputError(
                "measures_turns: expected false with saccades, whose turns are measured anyway"
            )
        if 0 < self.fixation_iterations < _LEAST_FIXATION:
            raise InputError(
                f"fixation_iterations: expected 0, or {_LEAST_FIXATION} or more, of which "
                f"{N_SACCADES} are saccades, got {self.fixation_iterations}"
            )

    @property
    def learns_turns(self) -> bool:
        """Whether vergence is learned as turns of the eyes, in place of activations."""
        return self.fixation_iterations > 0 or self.measures_turns

    @property
    def n_before(self) -> int:
        """Iterations of a fixation or an episode before vergence learns from what it does."""
        return N_SACCADES if self.fixation_iterations else int(self.measures_turns)

    def check_fits(
        self, iterations_per_episode: int, command_space: str, learning_rule: str
    ) -> None:
        """Raise InputError unless episodes are whole fixations and the eyes can be turned."""
        if self.fixation_iterations and iterations_per_episode % self.fixation_iterations:
            raise InputError(
                f"iterations_per_episode: expected a multiple of {self.fixation_iterations} "
                f"(gaze.fixation_iterations), got {iterations_per_episode}"
            )
        if not self.learns_turns:
            return
        name, none = (
            ("measures_turns", "false") if self.measures_turns else ("fixation_iterations", "0")
        )
        if command_space != ALL_MUSCLES:
            raise InputError(
                f"gaze.{name}: expected {none} with command_space {command_space}, since each eye "
                "is turned about all axes"
            )
        if learning_rule == "cacla":
            raise InputError(
                f"gaze.{name}: expected {none} with learning_rule cacla, whose actions are changes "
                "of activation and not turns of the eyes"
            )
