"""The configuration of both eyes' cameras and of what stands before them."""

import math
from dataclasses import dataclass

from lockstep.errors import InputError


@dataclass(frozen=True)
class CameraConfig:
    """Two equal pinhole cameras, the plane and the landscape (K17, section on the environment).

    Of the two fields of view that K17 gives only F = 257.34 px fits both: 50 deg is the vertical
    one, 2 atan(120 / F). One pixel is 0.2226 deg.
    """

    width_px: int = 320
    height_px: int = 240
    focal_length_px: float = 257.34
    # Region of interest: only the picture's centre is drawn, read and returned. Its pixels are the
    # full picture's, bit by bit.
    roi_width_px: int = 320
    roi_height_px: int = 240
    plane_size_m: float = 3.0
    landscape_distance_m: float = 9.1
    landscape_width_m: float = 39.0
    landscape_height_m: float = 12.0
    landscape_seed: int = 0
    # Altered rearing: each eye's picture can be blurred (Gaussian, standard deviation), magnified
    # about its centre, or black.
    left_blur_px: float = 0.0
    right_blur_px: float = 0.0
    left_magnification: float = 1.0
    right_magnification: float = 1.0
    left_occluded: bool = False
    right_occluded: bool = False

    def __post_init__(self) -> None:
        """Refuse a configuration that cannot be drawn, naming the parameter."""
        for name in ("width_px", "height_px", "roi_width_px", "roi_height_px"):
            _require(self, name, getattr(self, name) >= 2, "2 or more")
            _require(self, name, getattr(self, name) % 2 == 0, "an even number")
        _require(self, "roi_width_px", self.roi_width_px <= self.width_px, "width_px or less")
        _require(self, "roi_height_px", self.roi_height_px <= self.height_px, "height_px or less")
        for name in (
            "focal_length_px",
            "plane_size_m",
            "landscape_width_m",
            "landscape_height_m",
            "left_magnification",
            "right_magnification",
        ):
            value = getattr(self, name)
            _require(self, name, math.isfinite(value) and value > 0.0, "a positive number")
        _require(
            self, "landscape_distance_m", 0.2 <= self.landscape_distance_m <= 19.0, "0.2 to 19"
        )
        for name in ("left_blur_px", "right_blur_px"):
            _require(self, name, 0.0 <= getattr(self, name) <= 100.0, "0 to 100")

    @property
    def magnifications(self) -> tuple[float, float]:
        """Of the left and the right eye's picture."""
        return self.left_magnification, self.right_magnification

    @property
    def blurs_px(self) -> tuple[float, float]:
        """Standard deviation of the left and the right eye's blur."""
        return self.left_blur_px, self.right_blur_px

    @property
    def occlusions(self) -> tuple[bool, bool]:
        """Whether the left and the right eye's picture is black."""
        return self.left_occluded, self.right_occluded


def _require(config: CameraConfig, name: str, holds: bool, expected: str) -> None:
    if not holds:
        raise InputError(f"camera.{name}: expected {expected}, got {getattr(config, name)}")
