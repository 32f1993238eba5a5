"""The configuration of both eyes' cameras and of what stands before them."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from eye_plant.camera.blur import blur_radius_px
from eye_plant.turns import TurnsDeg
from lockstep import InputError, check_settings, setting
from lockstep.optics import OpticsConfig

MUJOCO = "mujoco"
PLANE = "plane"
RENDERERS = (PLANE, MUJOCO)

_BLURS = tuple(
    f"{side}_{kind}blur_px"
    for side in ("left", "right")
    for kind in ("", "horizontal_", "vertical_")
)


def _blur_px(text: str) -> Any:
    return setting(0.0, text, "px", least=0)


def _turn_deg(text: str) -> Any:
    return setting(0.0, text, "deg", least=-45, most=45)


@dataclass(frozen=True)
class CameraTurns:
    """How each camera is turned in its eye, as a prism before the eye turns its picture."""

    left_rotation_deg: float = _turn_deg(
        "rotation of the left camera in its eye, positive toward the nose"
    )
    right_rotation_deg: float = _turn_deg(
        "rotation of the right camera in its eye, positive toward the nose"
    )
    left_elevation_deg: float = _turn_deg(
        "elevation of the left camera in its eye, turned after left_rotation_deg; positive upwards"
    )
    right_elevation_deg: float = _turn_deg(
        "elevation of the right camera in its eye, turned after right_rotation_deg; positive"
        " upwards"
    )
    left_roll_deg: float = _turn_deg(
        "rotation of the left camera about its line of sight, its upper side toward the nose"
        " positive"
    )
    right_roll_deg: float = _turn_deg(
        "rotation of the right camera about its line of sight, its upper side toward the nose"
        " positive"
    )

    def __post_init__(self) -> None:
        """Refuse values out of range."""
        check_settings(self)

    @property
    def turns_deg(self) -> TurnsDeg:
        """Rotation toward the nose, elevation and roll of the left and the right eye's camera."""
        return (
            (self.left_rotation_deg, self.left_elevation_deg, self.left_roll_deg),
            (self.right_rotation_deg, self.right_elevation_deg, self.right_roll_deg),
        )


@dataclass(frozen=True)
class CameraConfig(CameraTurns, OpticsConfig):
    """Two equal pinhole cameras, the plane and the landscape (K17, section on the environment).

    Of the two fields of view that K17 gives only F = 257.34 px fits both: 50 deg is the vertical
    one, 2 atan(120 / F) (D2). One pixel is 0.2226 deg.
    """

    renderer: str = setting(
        PLANE,
        "renderer: a ray caster of plane and landscape, or MuJoCo's own, which needs OpenGL and is"
        " slower",
        choices=RENDERERS,
    )
    width_px: int = setting(320, "width of each image", "px", least=2, multiple_of=2)
    height_px: int = setting(240, "height of each image", "px", least=2, multiple_of=2)
    roi_width_px: int = setting(
        320,
        "width of the region of interest about the image's centre; only this region is drawn,"
        " with the same bits as in the full image",
        "px",
        least=2,
        multiple_of=2,
    )
    roi_height_px: int = setting(
        240, "height of the region of interest", "px", least=2, multiple_of=2
    )
    plane_size_m: float = setting(3.0, "width and height of the textured plane", "m", above=0)
    landscape_distance_m: float = setting(
        9.1, "distance of the landscape behind the plane", "m", least=0.2, most=19
    )
    landscape_width_m: float = setting(39.0, "width of the landscape", "m", above=0)
    landscape_height_m: float = setting(12.0, "height of the landscape", "m", above=0)
    landscape_seed: int = setting(0, "seed of the generated landscape")
    left_blur_px: float = _blur_px("standard deviation of the Gaussian blur of the left image")
    right_blur_px: float = _blur_px("standard deviation of the Gaussian blur of the right image")
    left_horizontal_blur_px: float = _blur_px(
        "additional blur of the left image along its rows; it removes vertical stripes"
    )
    right_horizontal_blur_px: float = _blur_px("additional blur of the right image along its rows")
    left_vertical_blur_px: float = _blur_px(
        "additional blur of the left image along its columns; it removes horizontal stripes"
    )
    right_vertical_blur_px: float = _blur_px("additional blur of the right image along its columns")
    left_magnification: float = setting(
        1.0, "magnification of the left image about its centre", above=0
    )
    right_magnification: float = setting(
        1.0, "magnification of the right image about its centre", above=0
    )
    left_cataract: float = setting(
        0.0,
        "share of the light that the lens of the left eye scatters, as an even veil of mid-grey",
        least=0,
        most=1,
    )
    right_cataract: float = setting(
        0.0, "share of the light that the lens of the right eye scatters", least=0, most=1
    )
    left_occluded: bool = setting(False, "whether the left image is black")
    right_occluded: bool = setting(False, "whether the right image is black")

    def __post_init__(self) -> None:
        """Refuse a configuration that cannot be drawn."""
        check_settings(self)
        for side in ("width_px", "height_px"):
            most, roi = getattr(self, side), getattr(self, f"roi_{side}")
            if roi > most:
                raise InputError(f"roi_{side}: expected {side}, {most}, or less, got {roi}")
        widest_px = max(self.width_px, self.height_px)
        for name in _BLURS:
            if getattr(self, name) > widest_px:
                raise InputError(
                    f"{name}: expected 0 to {widest_px}, the image's longer side (a wider blur "
                    f"leaves one even grey), got {getattr(self, name)}"
                )

    @property
    def magnifications(self) -> tuple[float, float]:
        """Of the left and the right eye's picture."""
        return self.left_magnification, self.right_magnification

    @property
    def blurs_px(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Standard deviations of the blur along rows and columns, of the left and the right eye.

        Blurs one after the other are one blur, whose variance is the sum of theirs.
        """
        left, right = (
            (
                math.hypot(blur_px, getattr(self, f"{side}_horizontal_blur_px")),
                math.hypot(blur_px, getattr(self, f"{side}_vertical_blur_px")),
            )
            for side, blur_px in (("left", self.left_blur_px), ("right", self.right_blur_px))
        )
        return left, right

    @cached_property
    def drawn_px(self) -> tuple[int, int]:
        """Width and height to draw: the region of interest and what blur mixes into it."""
        along_rows, along_columns = (
            2 * max(map(blur_radius_px, blurs_px)) for blurs_px in zip(*self.blurs_px, strict=True)
        )
        return (
            min(self.width_px, self.roi_width_px + along_rows),
            min(self.height_px, self.roi_height_px + along_columns),
        )

    @property
    def cataracts(self) -> tuple[float, float]:
        """Share of the light that is scattered, of the left and the right eye."""
        return self.left_cataract, self.right_cataract

    @property
    def occlusions(self) -> tuple[bool, bool]:
        """Whether the left and the right eye's picture is black."""
        return self.left_occluded, self.right_occluded
