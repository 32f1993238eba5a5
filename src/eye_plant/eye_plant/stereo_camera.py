"""Both eyes' pictures of the scene: what is checked before and done after they are drawn."""

import copy
import functools
from collections.abc import Iterator
from typing import Any

import numpy as np

from eye_plant.camera.config import MUJOCO, CameraConfig
from eye_plant.camera.mujoco_renderer import MujocoRenderer
from eye_plant.camera.ray_casting.plane_renderer import PlaneRenderer
from eye_plant.camera.renderer import Renderer, View
from eye_plant.camera.retina import Retina
from eye_plant.lens.lenses import LensState
from eye_plant.stimuli.stimulus_set import StimulusSet
from eye_plant.turns import turned
from lockstep import InputError
from lockstep.scales import Scale, ScalesConfig

_NEAREST_M = 0.1
_GAP_TO_LANDSCAPE_M = 0.1
_NO_SCALES = ScalesConfig()


class StereoCamera:
    """Draws what two eyes see: stimulus i on the plane at a distance, the landscape behind it.

    The camera knows nothing of muscles: it takes the eyes' poses and what their lenses do. The
    renderer that the configuration names draws; its retinas do the rest.

    Deterministic: the same arguments give the same bits on one machine. Use it from one thread.
    """

    def __init__(
        self,
        config: CameraConfig,
        stimuli: StimulusSet,
        eye_height_m: float = 1.7,
        scales: ScalesConfig = _NO_SCALES,
        *,
        focuses: bool = False,
    ) -> None:
        """Give the stimuli to the renderer.

        stimuli: grey pictures, and stereograms, which have one for each eye; each is stretched over
        the whole plane, row 0 on top. eye_height_m: height of the plane's and the landscape's
        centres; scales: those with pictures of their own have them drawn; focuses: whether the eyes
        have lenses. Raises InputError for a picture of another kind, and for pictures of their own
        by another renderer than the ray caster.
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
        if scales.apart and config.renderer == MUJOCO:
            raise InputError(
                f"camera.renderer: expected plane, which draws {scales.apart[0].name} apart, got "
                f"{MUJOCO}"
            )
        self._stimuli, self._eye_height_m = stimuli, eye_height_m
        self._scales, self._focuses = scales, focuses
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
        # Each retina has a renderer, with settings of its own.
        other._take_settings_of(self._config)
        return other

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle as what the camera was made of."""
        made_of = self._config, self._stimuli, self._eye_height_m, self._scales
        return functools.partial(StereoCamera, focuses=self._focuses), made_of

    def reconfigure(self, config: CameraConfig) -> None:
        """Take other settings, of the same renderer and size of pictures; the stimuli stay."""
        self._take_settings_of(config)

    def _take_settings_of(self, config: CameraConfig) -> None:
        self._config = config
        self._retina = Retina(config, self._renderer, focuses=self._focuses)
        self._retinas_apart = [
            Retina.of_scale(config, scale, copy.copy(self._renderer), focuses=self._focuses)
            for scale in self._scales.apart
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
        lenses: LensState | None = None,
    ) -> np.ndarray:
        """Return both eyes' pictures, (2, roi_height, roi_width) uint8, left first, row 0 on top.

        eye_positions_m (2, 3): the eyes' centres; eye_rotations (2, 3, 3): columns are the eyes'
        x (line of sight), y (left) and z (up) axes in world coordinates, so yaw, pitch and torsion
        all count; i_stimulus, distance_m: as `check` takes them; lenses: of eyes that focus, which
        blur all that is seen by the error of focus at the plane. The array is the caller's own.
        Raises InputError for a view that `check` refuses, and when MuJoCo's renderer lacks OpenGL.
        """
        view = self._view(eye_positions_m, eye_rotations, i_stimulus, distance_m)
        return self._retina.seen(self._retina.drawn(view), view, lenses)

    def render_apart(
        self,
        eye_positions_m: np.ndarray,
        eye_rotations: np.ndarray,
        i_stimulus: int,
        distance_m: float,
        lenses: LensState | None = None,
    ) -> Iterator[tuple[Scale, np.ndarray]]:
        """Yield each scale with a picture of its own, and both eyes' (2, window_px, window_px).

        As `render` does.
        """
        view = self._view(eye_positions_m, eye_rotations, i_stimulus, distance_m)
        # Scales that differ in the light's focus alone are drawn once.
        drawn: dict[tuple[float, int], np.ndarray] = {}
        for scale, retina in zip(self._scales.apart, self._retinas_apart, strict=True):
            shown = scale.zoom, scale.window_px
            if shown not in drawn:
                drawn[shown] = retina.drawn(view)
            yield scale, retina.seen(drawn[shown].copy(), view, lenses)

    def _view(
        self,
        eye_positions_m: np.ndarray,
        eye_rotations: np.ndarray,
        i_stimulus: int,
        distance_m: float,
    ) -> View:
        self.check(i_stimulus, distance_m)
        rotations = turned(eye_rotations, self._config.turns_deg)
        return View(eye_positions_m, rotations, self._i_textures[i_stimulus], distance_m)

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


def _check_picture(i_stimulus: int, picture: np.ndarray) -> None:
    if picture.dtype != np.uint8 or picture.ndim != 2 or picture.size == 0:
        raise InputError(
            f"stimulus {i_stimulus}: expected a grey image (height, width) of uint8, "
            f"got shape {picture.shape} of {picture.dtype}"
        )
