"""Both eyes' pictures of the scene: what is checked before and done after they are drawn."""

import copy
from typing import Any

import numpy as np

from eye_plant.camera.blur import Blur
from eye_plant.camera.config import MUJOCO, CameraConfig
from eye_plant.camera.mujoco_renderer import MujocoRenderer
from eye_plant.camera.ray_casting.plane_renderer import PlaneRenderer
from eye_plant.camera.renderer import Renderer, View
from eye_plant.stimuli.stimulus_set import StimulusSet
from eye_plant.turns import turned
from lockstep import InputError

_NEAREST_M = 0.1
_GAP_TO_LANDSCAPE_M = 0.1


class StereoCamera:
    """Draws what two eyes see: stimulus i on the plane at a distance, the landscape behind it.

    The camera knows nothing of muscles: it takes the eyes' poses. The renderer that the
    configuration names draws; blur, occlusion and the region of interest are done here.

    Deterministic: the same arguments give the same bits on one machine. Use it from one thread.
    """

    def __init__(
        self, config: CameraConfig, stimuli: StimulusSet, eye_height_m: float = 1.7
    ) -> None:
        """Give the stimuli to the renderer.

        stimuli: grey pictures, and stereograms, which have one for each eye; each is stretched over
        the whole plane, row 0 on top. eye_height_m: height of the plane's and the landscape's
        centres. Raises InputError for a picture of another kind.
        """
        textures = list(stimuli.all)
        self._i_textures = [(i, i) for i in range(len(textures))]
        self._parallax = [0.0] * len(textures)
        for stereogram in stimuli.stereograms:
            self._i_textures.append((len(textures), len(textures) + 1))
            self._parallax.append(stereogram.parallax)
            textures += [stereogram.left, stereogram.right]
        for i_texture, texture in enumerate(textures):
            _check_picture(i_texture, texture)
        self.n_stimuli = len(self._i_textures)
        self._stimuli, self._eye_height_m = stimuli, eye_height_m
        self._renderer: Renderer = (
            MujocoRenderer(config, eye_height_m, textures)
            if config.renderer == MUJOCO
            else PlaneRenderer(config, eye_height_m, textures)
        )
        self._take_settings_of(config)

    def __deepcopy__(self, memo: object) -> "StereoCamera":
        """Share the pictures and what was made of them, which nobody changes."""
        other = object.__new__(StereoCamera)
        other.__dict__.update(self.__dict__, _renderer=copy.copy(self._renderer))
        return other

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle as what the camera was made of."""
        return StereoCamera, (self._config, self._stimuli, self._eye_height_m)

    def reconfigure(self, config: CameraConfig) -> None:
        """Take other settings, of the same renderer and size of pictures; the stimuli stay."""
        self._renderer.reconfigure(config)
        self._take_settings_of(config)

    def _take_settings_of(self, config: CameraConfig) -> None:
        self._config = config
        kept_px = config.roi_width_px, config.roi_height_px
        self._blurs = [
            Blur(config.drawn_px, kept_px, blur_px) if any(blur_px) else None
            for blur_px in config.blurs_px
        ]

    def parallax_m(self, i_stimulus: int) -> float:
        """Return how much farther right on the plane the left eye sees what both see."""
        return self._parallax[i_stimulus] * self._config.plane_size_m

    def render(
        self,
        eye_positions_m: np.ndarray,
        eye_rotations: np.ndarray,
        i_stimulus: int,
        distance_m: float,
    ) -> np.ndarray:
        """Return both eyes' pictures, (2, roi_height, roi_width) uint8, left first, row 0 on top.

        eye_positions_m (2, 3): the eyes' centres; eye_rotations (2, 3, 3): columns are the eyes'
        x (line of sight), y (left) and z (up) axes in world coordinates, so yaw, pitch and torsion
        all count; i_stimulus, distance_m: as `check` takes them. The array is the caller's own.
        Raises InputError for a view that `check` refuses, and when MuJoCo's renderer lacks OpenGL.
        """
        self.check(i_stimulus, distance_m)
        rotations = turned(eye_rotations, self._config.turns_deg)
        view = View(eye_positions_m, rotations, self._i_textures[i_stimulus], distance_m)
        return self._manipulated(self._renderer.draw(view))

    def check(self, i_stimulus: int, distance_m: float) -> None:
        """Raise InputError unless stimulus i_stimulus can be shown at distance_m.

        i_stimulus in [0, n_stimuli); distance_m from the eyes' frontal plane x = 0, in [0.1, 9]
        with the default landscape.
        """
        if not 0 <= i_stimulus < self.n_stimuli:
            raise InputError(f"stimulus: expected 0 to {self.n_stimuli - 1}, got {i_stimulus}")
        farthest_m = self._config.landscape_distance_m - _GAP_TO_LANDSCAPE_M
        if not _NEAREST_M <= distance_m <= farthest_m:
            raise InputError(
                f"object_distance_m: expected {_NEAREST_M} to {farthest_m:g}, got {distance_m}"
            )

    def close(self) -> None:
        """Release the renderer; the camera draws no more."""
        self._renderer.close()

    def _manipulated(self, pictures: np.ndarray) -> np.ndarray:
        """Return the pictures (2, height, width) as the eyes get them: blurred, black, cropped."""
        top = (pictures.shape[1] - self._config.roi_height_px) // 2
        left = (pictures.shape[2] - self._config.roi_width_px) // 2
        bottom, right = top + self._config.roi_height_px, left + self._config.roi_width_px
        kept = pictures[:, top:bottom, left:right]
        # What a renderer returns is the caller's own.
        kept = kept if top == left == 0 else kept.copy()
        for i_eye, blur in enumerate(self._blurs):
            if self._config.occlusions[i_eye]:
                kept[i_eye] = 0
            elif blur is not None:
                kept[i_eye] = blur(pictures[i_eye])
        return kept


def _check_picture(i_stimulus: int, picture: np.ndarray) -> None:
    if picture.dtype != np.uint8 or picture.ndim != 2 or picture.size == 0:
        raise InputError(
            f"stimulus {i_stimulus}: expected a grey image (height, width) of uint8, "
            f"got shape {picture.shape} of {picture.dtype}"
        )
