"""A slow oracle for renderers: a pinhole camera worked out ray by ray in NumPy."""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import map_coordinates

from eye_plant.camera.config import CameraConfig
from eye_plant.camera.landscape import landscape_picture
from eye_plant.camera.mipmaps import mipmap_levels, reduced
from eye_plant.camera.renderer import FAR_M, NEAR_M, View, shows_reduced
from tests.eye_plant.rotations import rotation

EYE_HEIGHT_M = 1.7
POSITIONS_M = np.array([[0.0, 0.028, EYE_HEIGHT_M], [0.0, -0.028, EYE_HEIGHT_M]])
# Of edges and of changes from one mip-map level to the next: nearer, rounding decides.
_SEAM_PX = 0.02
_SEAM_OCTAVES = 1e-3


@dataclass(frozen=True)
class Surface:
    """A rectangle that faces the eyes, its centre at their height."""

    distance_m: float
    width_m: float
    height_m: float

    def hit(
        self, config: CameraConfig, view: View, i_eye: int, shift_px: tuple[float, float] = (0, 0)
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return where each pixel's ray meets the surface's plane, (2, height, width), and whether.

        From (0, 0), the surface's top left corner, to (1, 1); (height, width): whether it meets the
        surface itself, before the eye. shift_px: right and down, of all rays.
        """
        column, row = np.meshgrid(np.arange(config.width_px), np.arange(config.height_px))
        right_px = column - (config.width_px - 1) / 2 + shift_px[0]
        down_px = row - (config.height_px - 1) / 2 + shift_px[1]
        focal_px = config.focal_length_px * config.magnifications[i_eye]
        in_eye = np.stack((np.full(column.shape, focal_px), -right_px, -down_px), axis=-1)
        ray = in_eye @ view.eye_rotations[i_eye].T
        position_m = view.eye_positions_m[i_eye]
        steps = (self.distance_m - position_m[0]) / ray[..., 0]
        point_m = position_m + ray * steps[..., None]
        right = 0.5 - point_m[..., 1] / self.width_m
        down = 0.5 - (point_m[..., 2] - EYE_HEIGHT_M) / self.height_m
        uv = np.stack((right, down))
        is_drawn = (steps * focal_px >= NEAR_M) & (steps * focal_px <= FAR_M)
        return uv, (np.abs(uv - 0.5) <= 0.5).all(axis=0) & is_drawn


def plane_of(config: CameraConfig, view: View) -> Surface:
    """Return the plane that carries the stimulus."""
    return Surface(view.distance_m, config.plane_size_m, config.plane_size_m)


def landscape_of(config: CameraConfig) -> Surface:
    """Return the wall behind it."""
    return Surface(config.landscape_distance_m, config.landscape_width_m, config.landscape_height_m)


def near_outlines(config: CameraConfig, view: View, i_eye: int, reach_px: float) -> np.ndarray:
    """Return which pixels (height, width) lie so near the outline of a surface."""
    found = np.zeros((config.height_px, config.width_px), bool)
    shifts_px = ((reach_px, 0.0), (-reach_px, 0.0), (0.0, reach_px), (0.0, -reach_px))
    for surface in (plane_of(config, view), landscape_of(config)):
        around = [surface.hit(config, view, i_eye, shift_px)[1] for shift_px in shifts_px]
        found |= np.any(around, axis=0) & ~np.all(around, axis=0)
    return found


def drawn_slowly(
    config: CameraConfig, stimulus: np.ndarray, view: View, i_eye: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return one eye's full picture (height, width), not rounded, and where rounding decides."""
    picture = np.zeros((config.height_px, config.width_px))
    is_seam = near_outlines(config, view, i_eye, _SEAM_PX)
    is_reduced = shows_reduced(config, max(stimulus.shape), view.distance_m)
    for surface, texture in (  # the nearer one last
        (landscape_of(config), landscape_picture(config.landscape_seed)),
        (plane_of(config, view), reduced(stimulus) if is_reduced else stimulus),
    ):
        uv, is_hit = surface.hit(config, view, i_eye)
        octave = _octave(uv * np.array(texture.shape[::-1])[:, None, None])
        is_seam |= np.abs(octave % 1.0 - 0.5) < _SEAM_OCTAVES
        levels = mipmap_levels(texture)
        i_level = np.clip(np.floor(octave + 0.5), 0, len(levels) - 1)
        for i in np.unique(i_level[is_hit]).astype(int):
            wanted = is_hit & (i_level == i)
            height_px, width_px = levels[i].shape
            texels = uv[1][wanted] * height_px - 0.5, uv[0][wanted] * width_px - 0.5
            found = map_coordinates(levels[i].astype(float), texels, order=1, mode="nearest")
            picture[wanted] = found
    return picture, is_seam


def _octave(texels: np.ndarray) -> np.ndarray:
    """Return log2 of the longer step (height, width) between pixels of each block of two by two.

    texels (2, height, width): where the rays hit; steps start from a block's lower left pixel.
    """
    start = texels[:, 1::2, 0::2]
    right, up = texels[:, 1::2, 1::2] - start, texels[:, 0::2, 0::2] - start
    longest = np.maximum((right**2).sum(axis=0), (up**2).sum(axis=0))
    return np.kron(0.5 * np.log2(longest), np.ones((2, 2)))


def random_view(number: int, n_stimuli: int, farthest_m: float) -> View:
    """Return a view of eyes that look almost anywhere, with one of the stimuli on the plane."""
    random = np.random.default_rng((17, number))
    angles_deg = random.uniform(-1.0, 1.0, (2, 3)) * random.choice([1.0, 10.0, 25.0])
    i_stimulus = int(random.integers(n_stimuli))
    return View(
        POSITIONS_M + random.normal(0.0, 0.01, (2, 3)),
        np.stack([rotation(*angles) for angles in angles_deg]),
        (i_stimulus, i_stimulus),
        float(np.exp(random.uniform(np.log(0.2), np.log(farthest_m)))),
    )


def central(pictures: np.ndarray, width_px: int, height_px: int) -> np.ndarray:
    """Return the middle of pictures (..., height, width)."""
    top, left = (pictures.shape[-2] - height_px) // 2, (pictures.shape[-1] - width_px) // 2
    return pictures[..., top : top + height_px, left : left + width_px]
