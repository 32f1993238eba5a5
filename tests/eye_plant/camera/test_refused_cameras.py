"""Cameras that cannot be made: stimuli, settings and sizes that nothing can draw."""

import numpy as np
import pytest

from eye_plant.camera.config import CameraConfig
from eye_plant.camera.opengl.offscreen import GraphicsError
from eye_plant.stereo_camera import StereoCamera
from eye_plant.stimuli.stimulus_set import StimulusSet
from lockstep.errors import InputError


@pytest.mark.parametrize(
    "stimulus", [np.zeros((8, 8, 3), np.uint8), np.zeros((8, 8)), np.zeros((0, 8), np.uint8)]
)
def test_a_stimulus_of_another_kind_is_refused(stimulus: np.ndarray) -> None:
    grey = np.zeros((8, 8), np.uint8)
    with pytest.raises(InputError, match="stimulus 1: expected a grey picture"):
        StereoCamera(CameraConfig(), StimulusSet((grey,), (stimulus,)))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"renderer": "vulkan"}, r"renderer: expected mujoco or plane, got 'vulkan'"),
        ({"roi_width_px": 322}, r"roi_width_px: expected width_px, 320, or less, got 322"),
        ({"roi_height_px": 127}, r"roi_height_px: expected a multiple of 2, 2 px or more, got 127"),
        ({"focal_length_px": float("nan")}, r"focal_length_px: expected more than 0 px, got nan"),
        ({"left_magnification": 0.0}, r"left_magnification: expected more than 0, got 0.0"),
        ({"right_blur_px": -1.0}, r"right_blur_px: expected 0 px or more, got -1"),
        ({"left_blur_px": 320.5}, r"left_blur_px: expected 0 to 320, the picture's longer side"),
        ({"right_vertical_blur_px": 1000.0}, r"right_vertical_blur_px: expected 0 to 320"),
        ({"left_horizontal_blur_px": -1.0}, r"left_horizontal_blur_px: expected 0 px or more"),
        ({"right_rotation_deg": 60.0}, r"right_rotation_deg: expected -45 to 45 deg"),
    ],
)
def test_a_configuration_that_cannot_be_drawn_is_refused(changes, message) -> None:
    with pytest.raises(InputError, match=message):
        CameraConfig(**changes)


def test_pictures_too_large_for_the_graphics_are_refused() -> None:
    grey = np.zeros((8, 8), np.uint8)
    with pytest.raises(
        GraphicsError, match="expected pictures that fit into one buffer of OpenGL here"
    ):
        StereoCamera(CameraConfig(width_px=40_000), StimulusSet((grey,), (grey,)))
