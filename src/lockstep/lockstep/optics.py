"""What others than the plant need of its cameras: what an angle is in a picture."""

from dataclasses import dataclass

from lockstep.settings import check_settings, setting


@dataclass(frozen=True)
class OpticsConfig:
    """Focal length and magnification; raises InputError for a value out of range."""

    focal_length_px: float = setting(257.34, "focal length of both cameras", "px", above=0)
    left_magnification: float = setting(
        1.0,
        "magnification of the left picture about its centre, of which the eyes that measure their"
        " turns do not know",
        above=0,
    )
    right_magnification: float = setting(
        1.0, "magnification of the right picture about its centre, likewise", above=0
    )

    def __post_init__(self) -> None:
        """Refuse values out of range."""
        check_settings(self)
