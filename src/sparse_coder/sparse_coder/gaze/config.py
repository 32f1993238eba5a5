"""Settings of what saccades need of the pictures."""

from dataclasses import dataclass

from lockstep.errors import InputError
from lockstep.settings import check_settings, setting


@dataclass(frozen=True)
class GazeConfig:
    """Settings of fixations; raises InputError for a value out of range."""

    fixation_iterations: int = setting(
        0,
        "iterations of a fixation, which begins with two saccades to the gaze target; 0: the eyes"
        " make no saccades (D22)",
        least=0,
    )
    measures_turns: bool = setting(
        False,
        "whether the turns of both eyes are measured without saccades, too, so that vergence can be"
        " learned as turns (D23)",
    )
    focal_length_px: float = setting(257.34, "focal length of both cameras", "px", above=0)

    def __post_init__(self) -> None:
        """Refuse values out of range."""
        check_settings(self)
        if self.fixation_iterations and self.measures_turns:
            raise InputError(
                "measures_turns: expected false with saccades, whose turns are measured anyway"
            )
