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
    saccade_noise: float = setting(
        0.0015,
        "standard deviation of the noise on each activation of a first saccade in training, from"
        " which saccades are learned (D22)",
        least=0,
    )

    def __post_init__(self) -> None:
        """Refuse values out of range."""
        check_settings(self)
        if 0 < self.fixation_iterations < _LEAST_FIXATION:
            raise InputError(
                f"gaze.fixation_iterations: expected 0, or {_LEAST_FIXATION} or more, of which "
                f"{N_SACCADES} are saccades, got {self.fixation_iterations}"
            )

    def check_fits(
        self, iterations_per_episode: int, command_space: str, learning_rule: str
    ) -> None:
        """Raise InputError unless episodes are whole fixations and the eyes can make saccades."""
        if not self.fixation_iterations:
            return
        if iterations_per_episode % self.fixation_iterations:
            raise InputError(
                f"iterations_per_episode: expected a multiple of {self.fixation_iterations} "
                f"(gaze.fixation_iterations), got {iterations_per_episode}"
            )
        if command_space != ALL_MUSCLES:
            raise InputError(
                f"gaze.fixation_iterations: expected 0 with command_space {command_space}, since "
                f"saccades turn each eye about all axes, got {self.fixation_iterations}"
            )
        if learning_rule == "cacla":
            raise InputError(
                "gaze.fixation_iterations: expected 0 with learning_rule cacla, whose actions are "
                f"changes of activation and not turns of the eyes, got {self.fixation_iterations}"
            )
