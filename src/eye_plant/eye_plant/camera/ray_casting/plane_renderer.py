"""Both eyes' pictures by casting one ray per pixel, on one core."""

from collections.abc import Sequence

import numpy as np

from eye_plant.camera.config import CameraConfig
from eye_plant.camera.landscape import landscape_picture
from eye_plant.camera.ray_casting.ray_caster import cast_rays
from eye_plant.camera.ray_casting.texture_storage import texture_of, textures_of
from eye_plant.camera.renderer import FAR_M, N_EYES, NEAR_M, View, shows_reduced


class PlaneRenderer:
    """Casts rays at the plane and at the landscape behind it."""

    def __init__(
        self, config: CameraConfig, eye_height_m: float, stimuli: Sequence[np.ndarray]
    ) -> None:
        """Lay out the stimuli; the arguments are those that StereoCamera takes."""
        self._config = config
        self._eye_height_m = eye_height_m
        self._sizes_px = [max(stimulus.shape) for stimulus in stimuli]
        self._textures = textures_of(stimuli)
        self._landscape = texture_of(landscape_picture(config.landscape_seed))

    def reconfigure(self, config: CameraConfig) -> None:
        """Draw as another configuration has it; the stimuli stay."""
        if config.landscape_seed != self._config.landscape_seed:
            self._landscape = texture_of(landscape_picture(config.landscape_seed))
        self._config = config

    def draw(self, view: View) -> np.ndarray:
        """Return both eyes' pictures."""
        width_px, height_px = self._config.drawn_px
        pictures = np.empty((N_EYES, height_px, width_px), np.uint8)
        rectangles_m = self._rectangles_m(view.distance_m)
        for i_eye in range(N_EYES):
            self._draw_eye(pictures[i_eye], i_eye, view, rectangles_m)
        return pictures

    def close(self) -> None:
        """Forget the stimuli."""
        self._textures = []

    def _draw_eye(
        self, picture: np.ndarray, i_eye: int, view: View, rectangles_m: np.ndarray
    ) -> None:
        config = self._config
        width_px, height_px = config.drawn_px
        i_stimulus = view.i_stimuli[i_eye]
        is_reduced = shows_reduced(config, self._sizes_px[i_stimulus], view.distance_m)
        cast_rays(
            picture,
            ((config.width_px - width_px) // 2, (config.height_px - height_px) // 2),
            (view.eye_positions_m[i_eye], view.eye_rotations[i_eye]),
            (
                config.focal_length_px * config.magnifications[i_eye],
                (config.width_px - 1) / 2.0,
                (config.height_px - 1) / 2.0,
                NEAR_M,
                FAR_M,
            ),
            (rectangles_m, (self._textures[i_stimulus][is_reduced], self._landscape)),
        )

    def _rectangles_m(self, distance_m: float) -> np.ndarray:
        """Return distance, height of the centre, width and height of plane and landscape."""
        config = self._config
        return np.array(
            [
                [distance_m, self._eye_height_m, config.plane_size_m, config.plane_size_m],
                [
                    config.landscape_distance_m,
                    self._eye_height_m,
                    config.landscape_width_m,
                    config.landscape_height_m,
                ],
            ]
        )
