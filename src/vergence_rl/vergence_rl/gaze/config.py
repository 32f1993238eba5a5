"""Settings of how turns of the eyes are learned."""

from dataclasses import dataclass

from lockstep import check_settings, setting


@dataclass(frozen=True)
class GazeConfig:
    """Settings of saccades; raises InputError for a value out of range."""

    saccade_noise: float = setting(
        0.0015,
        "standard deviation of the noise on each activation of the first saccade, or the first"
        " command of an episode without saccades, in training; how activations rotate the eyes is"
        " learned from it (D22)",
        least=0,
    )
    memory_share: float = setting(
        0.0,
        "movements after which one has 1 / e of its weight in what is known of how activations"
        " rotate an eye, as a share of all so far; 0: all have the same weight (D22)",
        least=0,
    )
    torsion_weight: float = setting(
        1.0,
        "how many degrees sideways or up a degree of rotation about the line of sight counts as, in"
        " noise and distances of vergence that is learned as rotations: it moves the image less",
        above=0,
    )
    equal_innervation: bool = setting(
        False,
        "whether one model of how activations rotate an eye is learned from both eyes and commands"
        " both, so that they get equal innervation, mirrored (Hering's law), whatever one of them"
        " needs; else each eye has its own (D22)",
    )

    def __post_init__(self) -> None:
        """Refuse values out of range."""
        check_settings(self)
