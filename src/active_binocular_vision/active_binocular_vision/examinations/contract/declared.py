"""What each examination is called and may be told: what abv examine --help says, and no more.

The rest is with the examination, whose imports take a second.
"""

from dataclasses import dataclass
from typing import Any

from lockstep import SIDES, check_settings, setting


@dataclass(frozen=True)
class Options:
    """Of an examination without any; others declare theirs with `lockstep.settings.setting`."""

    def __post_init__(self) -> None:
        """Raise InputError for an option out of its bounds."""
        check_settings(self)


@dataclass(frozen=True)
class Distances(Options):
    """Where the eyes look."""

    distances_m: tuple[float, ...] = setting((0.5, 2.0, 6.0), "distances of the plane", "m")


@dataclass(frozen=True)
class TrialFrame(Options):
    """What is held before the left and the right eye, besides all that they wear."""

    lenses_d: tuple[float, ...] = setting(
        (0.0, 0.0), "power of the lens before each eye", "D", least=-20, most=20, n_entries=2
    )
    prisms_pd: tuple[float, ...] = setting(
        (0.0, 0.0),
        "power of the prism before each eye, base out above 0",
        "PD",
        least=-40,
        most=40,
        n_entries=2,
    )
    pinholes_mm: tuple[float, ...] = setting(
        (8.0, 8.0),
        "diameter of the hole before each eye; 8: none",
        "mm",
        above=0,
        most=8,
        n_entries=2,
    )


@dataclass(frozen=True)
class CoverOptions(TrialFrame, Distances):
    """Where the eyes look and begin, and what is before them."""

    at_rest: bool = setting(
        False, "whether the eyes begin with all muscles at their tonic level, not without errors"
    )
    at_habit: bool = setting(
        False, "whether the eyes begin as the last training episode before the checkpoint left them"
    )
    alternate: bool = setting(
        False,
        "whether the cover comes straight from the other eye, so that both see nothing together in"
        " between",
    )


@dataclass(frozen=True)
class PrismOptions(Options):
    """Where the eyes look, and how far the prisms go."""

    distances_m: tuple[float, ...] = setting((0.5, 6.0), "distances of the plane", "m")
    ladder_share: float = setting(
        1.0, "share of the steps up to the strongest prism of each direction", above=0.0, most=1.0
    )


@dataclass(frozen=True)
class AccommodationOptions(Options):
    """Where the objects are."""

    objects_d: tuple[float, ...] = setting(
        (0.2, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0), "of the objects, 1 / m", "D", above=0
    )
    distance_m: float = setting(1.0, "where lenses and prisms are tried", "m", above=0)


@dataclass(frozen=True)
class RetinoscopyOptions(TrialFrame):
    """Where the eyes look, and what is before them."""

    distances_m: tuple[float, ...] = setting((0.4,), "distances of the plane", "m")


@dataclass(frozen=True)
class NearPointOptions(TrialFrame):
    """From where to where the plane comes nearer, and what is before the eyes."""

    first_d: float = setting(1.0, "where the plane begins", "D", above=0)
    nearest_d: float = setting(8.0, "where it ends at the latest", "D", above=0)
    step_d: float = setting(0.25, "by how much it comes nearer", "D", above=0)


@dataclass(frozen=True)
class NinePositionsOptions(Distances):
    """Where the eyes look, told from the left one; one of them may see black."""

    covered: str = setting("", "eye that sees black", choices=("", *SIDES))
    n_random: int = setting(40, "random targets at each distance", least=4)


@dataclass(frozen=True)
class MainSequenceOptions(Options):
    """Where the targets are, seen from straight ahead."""

    amplitudes_deg: tuple[float, ...] = setting(
        (1.0, 2.0, 5.0, 10.0, 15.0, 20.0), "distances of targets from straight ahead", "deg"
    )
    directions_deg: tuple[float, ...] = setting(
        tuple(45.0 * i for i in range(8)), "of targets, counter-clockwise from the right", "deg"
    )


@dataclass(frozen=True)
class LandscapeOptions(Distances):
    """Distances and errors; a quarter of a degree is about a pixel."""

    vergence_errors_deg: tuple[float, ...] = setting(
        tuple(i / 4.0 for i in range(-16, 17)), "errors of vergence", "deg"
    )


@dataclass(frozen=True)
class Declared:
    """name: option of abv examine; text: what --help says; options: their class."""

    name: str
    text: str
    options: type[Any] = Options


DECLARED = {
    declared.name: declared
    for declared in (
        Declared(
            "cover",
            "cover one eye, then the other: phoria, and how the eyes fuse again",
            CoverOptions,
        ),
        Declared(
            "prisms",
            "shift and rotate the right eye's image as prisms do, until the eyes no longer fuse",
            PrismOptions,
        ),
        Declared(
            "acuity", "measure the acuity of each eye, and each eye's share in the code", Distances
        ),
        Declared(
            "stereo",
            "how small a disparity of random dots still decides whether the eyes converge",
            Distances,
        ),
        Declared(
            "accommodation",
            "objects, lenses and prisms before eyes with lenses: response, AC/A and CA/C",
            AccommodationOptions,
        ),
        Declared(
            "retinoscopy",
            "by how much each eye with a lens is focused farther than where both look",
            RetinoscopyOptions,
        ),
        Declared(
            "near-point",
            "bring the plane nearer until eyes with lenses no longer fuse it, or see it blurred",
            NearPointOptions,
        ),
        Declared(
            "nine-positions",
            "show nine gaze targets at three distances to eyes that make saccades: Hess chart,"
            " energy beside the least, and the laws of Sherrington, Listing and Hering",
            NinePositionsOptions,
        ),
        Declared(
            "main-sequence",
            "simulate first saccades of 1 to 20 deg over time: amplitude, peak velocity, duration",
            MainSequenceOptions,
        ),
        Declared(
            "landscape",
            "code images at vergence errors of -4 to 4 deg: the landscape of the reward",
            LandscapeOptions,
        ),
        Declared(
            "tuning",
            "fit Gabor functions to the dictionary: orientation, binocularity, preferred disparity",
        ),
    )
}
