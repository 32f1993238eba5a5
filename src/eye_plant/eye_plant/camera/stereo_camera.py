"""Both eyes' pictures of the scene, drawn off-screen by MuJoCo's own renderer."""

import math

import cv2
import mujoco
import numpy as np

from eye_plant.camera.config import CameraConfig
from eye_plant.camera.framebuffer import GreyFramebuffer
from eye_plant.camera.landscape import landscape_picture
from eye_plant.camera.offscreen import OffscreenContext
from eye_plant.camera.scene import (
    LANDSCAPE_GEOM,
    PLANE_GEOM,
    build_scene,
    build_scene_model,
    set_pose,
    set_projection,
)
from eye_plant.camera.textures import show_channel, upload_channels, upload_pictures
from eye_plant.stimuli.stimulus_set import StimulusSet
from lockstep.errors import InputError

__all__ = ["CameraConfig", "StereoCamera"]

_NEAREST_M = 0.1
_GAP_TO_LANDSCAPE_M = 0.1
_N_EYES = 2


class StereoCamera:
    """Draws what two eyes see: stimulus i on the plane at a distance, the landscape behind it.

    The camera owns its scene and knows nothing of muscles: it takes the eyes' poses. All stimuli
    live in the graphics memory (one byte per pixel, doubled by smaller copies), and nothing of them
    is kept outside it. Both eyes are drawn by one call of the renderer, side by side.

    Deterministic: the same arguments give the same bits on one machine. Use it from one thread.
    """

    def __init__(
        self, config: CameraConfig, stimuli: StimulusSet, eye_height_m: float = 1.7
    ) -> None:
        """Create the off-screen context and upload the stimuli.

        stimuli: grey pictures; each is stretched over the whole plane, row 0 on top. eye_height_m:
        height of the plane's and the landscape's centres. Raises InputError for a picture of
        another kind, GraphicsError when this machine cannot draw.
        """
        for i_stimulus, stimulus in enumerate(stimuli.all):
            _check_stimulus(i_stimulus, stimulus)
        self.n_stimuli = len(stimuli.all)
        self._config = config
        self._eye_height_m = eye_height_m
        self._drawn_px = _drawn_size_px(config)
        self._viewport = mujoco.MjrRect(0, 0, _N_EYES * config.width_px, config.height_px)
        buffer_size_px = _buffer_size_px(config, self._drawn_px)
        self._offscreen = OffscreenContext(*buffer_size_px)
        model = build_scene_model(config, eye_height_m, buffer_size_px)
        self._renderer = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_50)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._renderer)
        self._framebuffer = GreyFramebuffer(
            self._offscreen.gl, self._renderer.offFBO, *buffer_size_px
        )
        self._scene = build_scene(model)
        for camera, magnification in zip(self._scene.camera, config.magnifications, strict=True):
            set_projection(camera, config, magnification)
        self._upload(stimuli.all)
        self._mask_what_is_not_drawn()

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
        """Let the graphics hardware, or the threads that stand in for it, begin to draw.

        eye_positions_m (2, 3): the eyes' centres; eye_rotations (2, 3, 3): columns are the eyes'
        x (line of sight), y (left) and z (up) axes in world coordinates, so yaw, pitch and torsion
        all count; i_stimulus in [0, n_stimuli); distance_m from the eyes' frontal plane x = 0, in
        [0.1, 9] with the default landscape. Raises InputError, with nothing drawn, otherwise.
        """
        self.check(i_stimulus, distance_m)
        _check_array("eye_positions_m", eye_positions_m, (_N_EYES, 3))
        _check_array("eye_rotations", eye_rotations, (_N_EYES, 3, 3))
        self._offscreen.make_current()
        for i_eye in range(_N_EYES):
            set_pose(self._scene.camera[i_eye], eye_positions_m[i_eye], eye_rotations[i_eye])
        self._scene.geoms[PLANE_GEOM].pos = (distance_m, 0.0, self._eye_height_m)
        self._show(i_stimulus, distance_m)
        mujoco.mjr_render(self._viewport, self._scene, self._renderer)
        self._offscreen.gl.glFlush()

    def finish(self) -> np.ndarray:
        """Return the pictures that were started, (2, roi_height, roi_width) uint8.

        Left first, row 0 on top; the array is the caller's own.
        """
        return self._manipulated(self._read())

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
        """Free the graphics memory; the camera draws no more."""
        self._offscreen.make_current()
        self._offscreen.gl.glDeleteTextures(
            [*{name for t in self._textures for name in (t.full, t.reduced)}, self._landscape_name]
        )
        self._framebuffer.delete()
        self._renderer.free()
        self._offscreen.close()

    @property
    def renderer_name(self) -> str:
        """The device or software that draws, as OpenGL names it."""
        return self._offscreen.renderer

    def _upload(self, stimuli: tuple[np.ndarray, ...]) -> None:
        gl = self._offscreen.gl
        self._textures = upload_pictures(gl, stimuli)
        self._shown: tuple[int, int] | None = None
        landscape = landscape_picture(self._config.landscape_seed)
        self._landscape_name = upload_channels(gl, [landscape])
        self._renderer.texture[LANDSCAPE_GEOM] = self._landscape_name

    def _show(self, i_stimulus: int, distance_m: float) -> None:
        """Put the stimulus on the plane, at the size that suits the distance.

        An eye's magnification must not touch what the other eye sees, and does not count.
        """
        config, texture = self._config, self._textures[i_stimulus]
        pixel_m = distance_m / config.focal_length_px
        name = texture.name_for(pixel_m * texture.size_px / config.plane_size_m)
        if self._shown != (name, texture.channel):
            show_channel(self._offscreen.gl, name, texture.channel)
            self._renderer.texture[PLANE_GEOM] = name
            self._shown = (name, texture.channel)

    def _mask_what_is_not_drawn(self) -> None:
        """Let the stencil buffer stop all drawing outside the region of interest, from here on.

        A smaller or shifted viewport would change the rounding of texture coordinates; a stencil
        leaves the pixels inside as they are. The renderer touches no stencil without reflections,
        and a write mask of zero keeps it from being cleared.
        """
        if self._drawn_px == (self._config.width_px, self._config.height_px):
            return
        gl = self._offscreen.gl
        gl.glClearStencil(0)
        gl.glClear(gl.GL_STENCIL_BUFFER_BIT)
        gl.glClearStencil(1)
        gl.glEnable(gl.GL_SCISSOR_TEST)
        for i_eye in range(_N_EYES):
            gl.glScissor(*self._origin_px(i_eye), *self._drawn_px)
            gl.glClear(gl.GL_STENCIL_BUFFER_BIT)
        gl.glDisable(gl.GL_SCISSOR_TEST)
        gl.glStencilFunc(gl.GL_EQUAL, 1, 1)
        gl.glStencilMask(0)
        gl.glEnable(gl.GL_STENCIL_TEST)

    def _origin_px(self, i_eye: int) -> tuple[int, int]:
        """Return where in the buffer one eye's drawn region starts, from its bottom left."""
        width_px, height_px = self._drawn_px
        return (
            i_eye * self._config.width_px + (self._config.width_px - width_px) // 2,
            (self._config.height_px - height_px) // 2,
        )

    def _read(self) -> np.ndarray:
        """Return what was drawn, (2, height, width) of the drawn region."""
        gl = self._offscreen.gl
        width_px, height_px = self._drawn_px
        left_px, bottom_px = self._origin_px(0)
        span_px = self._origin_px(1)[0] + width_px - left_px
        rows = np.empty((height_px, span_px), np.uint8)
        gl.glPixelStorei(gl.GL_PACK_ALIGNMENT, 1)
        gl.glReadPixels(
            left_px, bottom_px, span_px, height_px, gl.GL_RED, gl.GL_UNSIGNED_BYTE, rows
        )
        upright = rows[::-1]  # OpenGL's row 0 is at the bottom
        return np.stack((upright[:, :width_px], upright[:, span_px - width_px :]))

    def _manipulated(self, pictures: np.ndarray) -> np.ndarray:
        """Return the pictures (2, height, width) as the eyes get them: blurred, black, cropped."""
        config = self._config
        for i_eye in range(_N_EYES):
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


def _buffer_size_px(config: CameraConfig, drawn_px: tuple[int, int]) -> tuple[int, int]:
    """Return width and height of the buffer: up to the right eye's region, and no further.

    What lies right of it and above it can be cut off without moving a pixel.
    """
    return (
        config.width_px + (config.width_px + drawn_px[0]) // 2,
        (config.height_px + drawn_px[1]) // 2,
    )


def _blur_radius_px(blur_px: float) -> int:
    return math.ceil(3.0 * blur_px)


def _blurred(picture: np.ndarray, blur_px: float) -> np.ndarray:
    """Return picture (height, width) convolved with a Gaussian cut off at three deviations."""
    size_px = 2 * _blur_radius_px(blur_px) + 1
    return cv2.GaussianBlur(picture, (size_px, size_px), blur_px)
