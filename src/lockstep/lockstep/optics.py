"""What nodes other than the plant need of the eyes: what an angle is in a picture, its noise."""

from dataclasses import dataclass
from typing import Any

from lockstep.settings import check_settings, setting


@dataclass(frozen=True)
class OpticsConfig:
    """Of both cameras; raises InputError for a value out of range."""

    focal_length_px: float = setting(
        257.34,
        "focal length of both cameras, magnification aside; turns of the eyes are measured with it",
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
        0.0, "standard deviation of the noise of each angle of a measured turn", "deg", least=0
    )
    missing_turns: float = share("turns of an eye that are not measured")

    def __post_init__(self) -> None:
        """Refuse values out of range."""
        check_settings(self)
