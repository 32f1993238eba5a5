"""What nodes other than the plant need of its cameras: what an angle is in a picture."""

from dataclasses import dataclass

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
