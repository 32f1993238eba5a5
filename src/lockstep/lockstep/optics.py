"""What nodes other than the plant need of the eyes: what an angle is in a picture, its noise."""

from dataclasses import dataclass
from typing import Any

from lockstep.settings import check_settings, setting


@dataclass(frozen=True)
class OpticsConfig:
    """Of both cameras; raises InputError for a value out of range."""

    focal_length_px: float = setting(
        257.34,
        "focal length of both cameras, magnification aside; rotations are measured with it",
        "px",
        above=0,
    )

    def __post_init__(self) -> None:
        """Refuse values out of range."""
        check_settings(self)


def share(of_what: str) -> Any:
    """Return a setting that is a share, 0 by default."""
    return setting(0.0, f"share of the {of_what}", least=0, most=1)


@dataclass(frozen=True)
class TurnNoiseConfig:
    """Noise of the turns that are measured in pictures; InputError for a value out of range."""

    turn_sd_deg: float = setting(
        0.0, "standard deviation of the noise of each angle of a measured rotation", "deg", least=0
    )
    missing_turns: float = share("rotations of an eye that are not measured")

    def __post_init__(self) -> None:
        """Refuse values out of range."""
        check_settings(self)


@dataclass(frozen=True)
class Pinhole:
    """A calibrated camera, as sensor_msgs/CameraInfo describes one.

    focal_px, centre_px: (2,) focal length and principal point, across and down, in the picture's
    pixels, whose centres are at whole numbers; distortion: the coefficients of plumb_bob or
    rational_polynomial, none of an ideal camera.
    """

    focal_px: tuple[float, float]
    centre_px: tuple[float, float]
    distortion: tuple[float, ...] = ()

    @classmethod
    def ideal(cls, focal_px: float, height_px: int, width_px: int) -> "Pinhole":
        """Return a camera without distortion whose principal point is the picture's centre."""
        return cls((focal_px, focal_px), ((width_px - 1) / 2.0, (height_px - 1) / 2.0))
