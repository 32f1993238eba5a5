"""Both eyes' pictures of the scene: what is checked before and done after they are drawn."""

import math

import cv2
import numpy as np

from eye_plant.camera.config import MUJOCO, CameraConfig
from eye_plant.camera.mujoco_renderer import MujocoRenderer
from eye_plant.camera.plane_renderer import PlaneRenderer
from eye_plant.camera.renderer import N_EYES, Renderer, View
from eye_plant.stimuli.stimulus_set import StimulusSet
from lockstep.errors import InputError

__all__ = ["CameraConfig", "StereoCamera"]

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

        stimuli: grey pictures; each is stretched over the whole plane, row 0 on top. eye_height_m:
        height of the plane's and the landscape's centres. Raises InputError for a picture of
        another kind, GraphicsError when this machine cannot draw.
        """
        for i_stimulus, stimulus in enumerate(stimuli.all):
            _check_stimulus(i_stimulus, stimulus)
        self.n_stimuli = len(stimuli.all)
        self._config = config
        self._renderer = _make_renderer(config, eye_height_m, stimuli)

    def render(
        self,
        eye_positions_m: np.ndarray,
        eye_rotations: np.ndarray,
        i_stimulus: int,
        distance_m: float,
    ) -> np.ndarray:
        """Return both eyes' pictures: `start` and `finish`, with nothing in between."""
        self.start(eye_positions_m, eye_rotations, i_stimulus, distance_m)
        return self.finish()

    def start(
        self,
        eye_positions_m: np.ndarray,
        eye_rotations: np.ndarray,
        i_stimulus: int,
        distance_m: float,
    ) -> None:
        """Begin to draw; a renderer may go on in other threads or in hardware.

        eye_positions_m (2, 3): the eyes' centres; eye_rotations (2, 3, 3): columns are the eyes'
        x (line of sight), y (left) and z (up) axes in world coordinates, so yaw, pitch and torsion
        all count; i_stimulus in [0, n_stimuli); distance_m from the eyes' frontal plane x = 0, in
        [0.1, 9] with the default landscape. Raises InputError, with nothing drawn, otherwise.
        """
        self.check(i_stimulus, distance_m)
        _check_array("eye_positions_m", eye_positions_m, (N_EYES, 3))
        _check_array("eye_rotations", eye_rotations, (N_EYES, 3, 3))
        view = View(eye_positions_m, eye_rotations, (i_stimulus, i_stimulus), distance_m)
        self._renderer.start(view)

    def finish(self) -> np.ndarray:
        """Return the pictures that were started, (2, roi_height, roi_width) uint8.

        Left first, row 0 on top; the array is the caller's own.
        """
        return self._manipulated(self._renderer.finish())

    def check(self, i_stimulus: int, distance_m: float) -> None:
        """Raise InputError unless stimulus i_stimulus can be shown at distance_m."""
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
        config = self._config
        for i_eye in range(N_EYES):
            if config.occlusions[i_eye]:
                pictures[i_eye] = 0
            elif config.blurs_px[i_eye] > 0.0:
                pictures[i_eye] = _blurred(pictures[i_eye], config.blurs_px[i_eye])
        top = (pictures.shape[1] - config.roi_height_px) // 2
        left = (pictures.shape[2] - config.roi_width_px) // 2
        if top == left == 0:
            return pictures
        bottom, right = top + config.roi_height_px, left + config.roi_width_px
        return pictures[:, top:bottom, left:right].copy()


def _make_renderer(config: CameraConfig, eye_height_m: float, stimuli: StimulusSet) -> Renderer:
    drawn_px = _drawn_size_px(config)
    if config.renderer == MUJOCO:
        return MujocoRenderer(config, drawn_px, eye_height_m, stimuli.all)
    return PlaneRenderer(config, drawn_px, eye_height_m, stimuli.all)


def _check_stimulus(i_stimulus: int, stimulus: np.ndarray) -> None:
    if stimulus.dtype != np.uint8 or stimulus.ndim != 2 or stimulus.size == 0:
        raise InputError(
            f"stimulus {i_stimulus}: expected a grey picture (height, width) of uint8, "
            f"got shape {stimulus.shape} of {stimulus.dtype}"
        )


def _check_array(name: str, values: np.ndarray, shape: tuple[int, ...]) -> None:
    if np.shape(values) != shape or not np.isfinite(values).all():
        raise InputError(f"{name}: expected finite numbers of shape {shape}, got {values!r}")


def _drawn_size_px(config: CameraConfig) -> tuple[int, int]:
    """Return width and height to draw: the region of interest and what blur mixes into it."""
    margin_px = max(_blur_radius_px(blur_px) for blur_px in config.blurs_px)
    return (
        min(config.width_px, config.roi_width_px + 2 * margin_px),
        min(config.height_px, config.roi_height_px + 2 * margin_px),
    )


def _blur_radius_px(blur_px: float) -> int:
    return math.ceil(3.0 * blur_px)


def _blurred(picture: np.ndarray, blur_px: float) -> np.ndarray:
    """Return picture (height, width) convolved with a Gaussian cut off at three deviations."""
    size_px = 2 * _blur_radius_px(blur_px) + 1
    return cv2.GaussianBlur(picture, (size_px, size_px), blur_px)
