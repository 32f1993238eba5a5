"""The pictures that the tests of the camera show: greys, marks, quadrants and noise."""

import cv2
import numpy as np

from eye_plant.stimuli.stimulus_set import StimulusSet

SIZE_PX = 1920
FOCAL_LENGTH_PX = 257.34
MARK_DISTANCES_M = (0.5, 1.0, 2.0, 4.0, 6.0)
FLAT_GREYS = (0, 1, 77, 128, 254, 255)


def mark(distance_m: float) -> np.ndarray:
    """A white Gaussian spot in the centre, its sigma 4 camera pixels seen from distance_m."""
    sigma_px = 4.0 * distance_m / FOCAL_LENGTH_PX / 3.0 * SIZE_PX
    offset_px = np.arange(SIZE_PX) - (SIZE_PX - 1) / 2.0
    profile = np.exp(-0.5 * (offset_px / sigma_px) ** 2)
    return np.rint(255.0 * np.outer(profile, profile)).astype(np.uint8)


def quadrants() -> np.ndarray:
    """Top left 200, top right 150, bottom left 100, bottom right 50."""
    return np.kron(np.array([[200, 150], [100, 50]], np.uint8), np.ones((32, 32), np.uint8))


def noise() -> np.ndarray:
    coarse = np.random.default_rng(0).integers(0, 256, (240, 240), dtype=np.uint8)
    return cv2.resize(coarse, (SIZE_PX, SIZE_PX), interpolation=cv2.INTER_CUBIC)


FLAT = {grey: i for i, grey in enumerate(FLAT_GREYS)}
MARK = {distance_m: len(FLAT) + i for i, distance_m in enumerate(MARK_DISTANCES_M)}
QUADRANTS = len(FLAT) + len(MARK)
NOISE = QUADRANTS + 1


def camera_stimuli() -> StimulusSet:
    """Return them all, under the numbers above."""
    flat = tuple(np.full((64, 64), grey, np.uint8) for grey in FLAT_GREYS)
    marks = tuple(mark(distance_m) for distance_m in MARK_DISTANCES_M)
    return StimulusSet((*flat, *marks), (quadrants(), noise()))
