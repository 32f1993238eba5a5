"""Both eyes' pictures by casting one ray per pixel: without OpenGL, on one core."""

from collections.abc import Sequence

import numpy as np

from eye_plant.camera.config import CameraConfig
from eye_plant.camera.landscape import landscape_picture
from eye_plant.camera.mipmaps import wants_reduced
from eye_plant.camera.ray_casting.ray_caster import cast_rays
from eye_plant.camera.ray_casting.texels import Texture, aliased_textures, texture_of, textures_of
from eye_plant.camera.renderer import FAR_M, N_EYES, NEAR_M, View


class PlaneRenderer:
    """Casts rays at the plane and at the landscape behind it; draws as MuJoCo's renderer does.

    Within one grey level of it on software OpenGL, except for pixels on the plane's outline and
    where two mip-map levels meet.
    """

    def __init__(
        self,
        config: CameraConfig,
        drawn_px: tuple[int, int],
        eye_height_m: float,
        stimuli: Sequence[np.ndarray],
    ) -> None:
        """drawn_px: width and height of the part to draw; the rest as StereoCamera takes it."""
        self._config = config
        self._drawn_px = drawn_px
        self._eye_height_m = eye_height_m
        self._sizes_px = [max(stimulus.shape) for stimulus in stimuli]
        self._textures = (
            textures_of(stimuli) if config.texture_mipmaps else aliased_textures(stimuli)
        )
        self._landscape = texture_of(landscape_picture(config.landscape_seed))
        self._pictures = self._empty()

    def reconfigure(self, config: CameraConfig, drawn_px: tuple[int, int]) -> None:
        """Draw as another configuration has it; the stimuli stay."""
        if config.landscape_seed != self._config.landscape_seed:
            self._landscape = texture_of(landscape_picture(config.landscape_seed))
        self._config, self._drawn_px = config, drawn_px
        self._pictures = self._empty()

    def start(self, view: View) -> None:
        """Draw the view."""
        self._pictures = self._empty()
        rectangles_m = self._rectangles_m(view.distance_m)
        for i_eye in range(N_EYES):
            self._draw(i_eye, view, rectangles_m)

    def finish(self) -> np.ndarray:
        """Return what was drawn, (2, height, width) uint8."""
        return self._pictures

    def close(self) -> None:
        """Forget the stimuli."""
        self._textures = []

    def _empty(self) -> np.ndarray:
        width_px, height_px = self._drawn_px
        return np.empty((N_EYES, height_px, width_px), np.uint8)

    def _draw(self, i_eye: int, view: View, rectangles_m: np.ndarray) -> None:
        config = self._config
        width_px, height_px = self._drawn_px
        plane = self._texture(view.i_stimuli[i_eye], view.distance_m)
        cast_rays(
            self._pictures[i_eye],
            ((config.width_px - width_px) // 2, (config.height_px - height_px) // 2),
            (view.eye_positions_m[i_eye], view.eye_rotations[i_eye]),
            (
                config.focal_length_px * config.magnifications[i_eye],
                (config.width_px - 1) / 2.0,
                (config.height_px - 1) / 2.0,
                NEAR_M,
                FAR_M,
            ),
            (rectangles_m, (plane.arrays, self._landscape.arrays)),
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

    def _texture(self, i_stimulus: int, distance_m: float) -> Texture:
        """Return the stimulus at the size that suits the distance; magnification does not count."""
        config = self._config
        pixel_m = distance_m / config.focal_length_px
        texels_per_pixel = pixel_m * self._sizes_px[i_stimulus] / config.plane_size_m
        return self._textures[i_stimulus][wants_reduced(texels_per_pixel)]
