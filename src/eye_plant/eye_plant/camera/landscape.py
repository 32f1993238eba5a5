"""The landscape behind the plane, generated (D10): what eyes see that look past it."""

from functools import lru_cache

import cv2
import numpy as np

from eye_plant.stimuli.noise import octaves_noise
from lockstep import generator

# 15 mm per pixel on a wall of 39 m x 12 m: less than half a camera pixel from 9.1 m away.
WIDTH_PX = 2600
HEIGHT_PX = 800
_HORIZON_PX = HEIGHT_PX // 2  # the wall's centre is at eye height
_N_RIDGES = 5
_N_TREES = 300
_N_CLUSTERS = 60  # of leaves, per tree


@lru_cache(maxsize=1)
def landscape_picture(seed: int) -> np.ndarray:
    """Return a grey landscape, (800, 2600) uint8: sky, ridges, fields, and trees before them.

    A function of the seed, read only. Everything carries 1/f texture: an even wall would be trivial
    to encode.
    """
    random = generator(seed, "landscape", 0)
    texture = octaves_noise(random, WIDTH_PX)
    sky, hills, ground = (texture[i * HEIGHT_PX : (i + 1) * HEIGHT_PX] for i in range(3))
    picture = 195.0 + 22.0 * sky
    _paint_ridges(random, picture, hills)
    _paint_fields(random, picture, ground)
    _paint_trees(random, picture)
    picture *= 1.0 + 0.08 * hills
    grey = np.clip(cv2.GaussianBlur(picture, (0, 0), 0.8), 0.0, 255.0).astype(np.uint8)
    grey.setflags(write=False)
    return grey


def _paint_ridges(random: np.random.Generator, picture: np.ndarray, texture: np.ndarray) -> None:
    """Paint hills one before the other, the nearer the lower and the darker, as through haze."""
    row = np.arange(HEIGHT_PX)[:, None]
    for i_ridge in range(_N_RIDGES):
        nearness = (i_ridge + 1) / _N_RIDGES
        shifted = np.roll(texture, int(random.integers(WIDTH_PX)), axis=1)
        profile = cv2.GaussianBlur(shifted[i_ridge][None], (0, 0), 8.0)[0]
        crest = _HORIZON_PX - 190.0 * (1.0 - nearness) - 40.0 * profile
        grey = 165.0 - 85.0 * nearness + (8.0 + 14.0 * nearness) * shifted
        np.copyto(picture, grey, where=row > crest)


def _paint_fields(random: np.random.Generator, picture: np.ndarray, texture: np.ndarray) -> None:
    """Paint the ground below the horizon: furrows that meet there, and clods."""
    row = np.arange(_HORIZON_PX, HEIGHT_PX, dtype=np.float32)[:, None]
    column = np.arange(WIDTH_PX, dtype=np.float32)[None]
    depth = 1.0 / (row - _HORIZON_PX + 12.0)
    vanishing_px = random.uniform(0.3, 0.7) * WIDTH_PX
    furrow = np.sin(2.0 * np.pi * 5.0 * (column - vanishing_px) * depth)
    field = np.sign(np.sin(2.0 * np.pi * (0.35 * (column - vanishing_px) * depth + 40.0 * depth)))
    ground = 110.0 + 25.0 * field + 14.0 * furrow + 26.0 * texture[_HORIZON_PX:]
    shown = row > _HORIZON_PX + 20.0
    np.copyto(picture[_HORIZON_PX:], ground, where=shown)


def _paint_trees(random: np.random.Generator, picture: np.ndarray) -> None:
    """Paint trees from the far to the near: a trunk, and a crown of many leaves' clusters."""
    for foot_px in np.sort(_HORIZON_PX + 300.0 * random.uniform(size=_N_TREES) ** 3.0):
        height_px = random.uniform(0.5, 1.5) * (20.0 + 0.8 * (foot_px - _HORIZON_PX))
        centre_px = random.uniform(0.0, WIDTH_PX)
        dark = random.uniform(10.0, 60.0)
        foot = (round(centre_px), round(foot_px))
        top = (round(centre_px), round(foot_px - 0.6 * height_px))
        cv2.line(picture, foot, top, dark, max(1, round(0.06 * height_px)))
        for _ in range(_N_CLUSTERS):
            offset = random.normal(0.0, 0.16 * height_px, 2)
            middle = (round(centre_px + offset[0]), round(foot_px - 0.7 * height_px + offset[1]))
            radius_px = max(1, round(random.uniform(0.02, 0.08) * height_px))
            cv2.circle(picture, middle, radius_px, dark + random.uniform(0.0, 80.0), cv2.FILLED)
