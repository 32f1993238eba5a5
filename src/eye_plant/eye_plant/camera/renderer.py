"""What draws for a StereoCamera: given a view, both eyes' pictures of the plane and the landscape.

A renderer knows neither blur nor occlusion nor regions of interest: those are the camera's, and the
same with every renderer.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from eye_plant.camera.config import CameraConfig
from eye_plant.camera.mipmaps import wants_reduced

N_EYES = 2
# Depth along an eye's line of sight between which surfaces are drawn.
NEAR_M = 0.01
FAR_M = 20.0


@dataclass(frozen=True)
class View:
    """Where the eyes are and what is on the plane.

    eye_positions_m (2, 3), eye_rotations (2, 3, 3): as StereoCamera.render takes them; i_stimuli:
    of the left and the right eye's plane; distance_m: of the plane from x = 0.
    """

    eye_positions_m: np.ndarray
    eye_rotations: np.ndarray
    i_stimuli: tuple[int, int]
    distance_m: float


def shows_reduced(config: CameraConfig, size_px: int, distance_m: float) -> bool:
    """Return whether the reduced copy of a stimulus suits its distance; size_px: its longer side.

    An eye's magnification must not touch what the other eye sees, and does not count.
    """
    pixel_m = distance_m / config.focal_length_px
    return wants_reduced(pixel_m * size_px / config.plane_size_m)


class Renderer(Protocol):
    """Draws the central part of both eyes' pictures, of the size CameraConfig.drawn_px.

    The same view gives the same bits on one machine, whatever was drawn before, and the same
    pixels in a smaller part. A copy, by deepcopy or pickle, draws the same.
    """

    def reconfigure(self, config: CameraConfig) -> None:
        """Draw as another configuration has it, and another part of the picture; stimuli stay."""

    def draw(self, view: View) -> np.ndarray:
        """Draw a view that the camera has checked: (2, height, width) uint8, left first.

        Row 0 is on top; the array is the caller's own.
        """

    def close(self) -> None:
        """Release what drawing needs."""
