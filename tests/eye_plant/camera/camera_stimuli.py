"""The pictures that the tests of the camera show: greys, marks, quadrants and noise."""

import cv2
import numpy as np

from eye_plant.camera.config import CameraConfig
from eye_plant.stimuli.stimulus_set import StimulusSet
from eye_plant.validation.dynamic_checks import DISTANCES_M, spot

SIZE_PX = 1920
FOCAL_LENGTH_PX = 257.34
FLAT_GREYS = (0, 1, 77, 128, 254, 255)


def quadrants() -> np.ndarray:
    """Top left 200, top right 150, bottom left 100, bottom right 50."""
    return np.kron(np.array([[200, 150], [100, 50]], np.uint8), np.ones((32, 32), np.uint8))


def noise() -> np.ndarray:
    coarse = np.random.default_rng(0).integers(0, 256, (240, 240), dtype=np.uint8)
    return cv2.resize(coarse, (SIZE_PX, SIZE_PX), interpolation=cv2.INTER_CUBIC)


FLAT = {grey: i for i, grey in enumerate(FLAT_GREYS)}
MARK = {distance_m: len(FLAT) + i for i, distance_m in enumerate(DISTANCES_M)}
QUADRANTS = len(FLAT) + len(MARK)
NOISE = QUADRANTS + 1


def camera_stimuli() -> StimulusSet:
    """Return them all, under the numbers above."""
    flat = tuple(np.full((64, 64), grey, np.uint8) for grey in FLAT_GREYS)
    marks = tuple(spot(CameraConfig(), distance_m) for distance_m in DISTANCES_M)
    return StimulusSet((*flat, *marks), (quadrants(), noise()))
