"""Both eyes' pictures by MuJoCo's own renderer, which draws with OpenGL, off-screen."""

from collections.abc import Sequence

import mujoco
import numpy as np

from eye_plant.camera.config import CameraConfig
from eye_plant.camera.landscape import landscape_picture
from eye_plant.camera.opengl.offscreen import GraphicsError, OffscreenContext
from eye_plant.camera.opengl.scene import (
    LANDSCAPE_GEOM,
    PLANE_GEOM,
    build_scene,
    build_scene_model,
    set_projection,
)
from eye_plant.camera.opengl.textures import upload_both_sizes, upload_picture
from eye_plant.camera.renderer import N_EYES, View, shows_reduced

# A compiled scene, and MuJoCo's renderer of it with the buffers that it draws into.
_Drawing = tuple[mujoco.MjModel, mujoco.MjrContext]


class MujocoRenderer:
    """Draws a scene of MuJoCo's, both eyes by one call, side by side.

    All stimuli live in the graphics memory (one byte per pixel, doubled by smaller copies), and
    nothing of them is kept outside it. Use it from one thread.
    """

    def __init__(
        self, config: CameraConfig, eye_height_m: float, stimuli: Sequence[np.ndarray]
    ) -> None:
        """Create the off-screen context and upload the stimuli; arguments as StereoCamera's.

        Raises GraphicsError when this machine cannot draw.
        """
        self._eye_height_m = eye_height_m
        self._offscreen = OffscreenContext(*_buffer_size_px(config))
        self._sizes_px = [max(stimulus.shape) for stimulus in stimuli]
        self._textures = [
            upload_both_sizes(self._offscreen.gl, stimulus, with_mipmaps=config.texture_mipmaps)
            for stimulus in stimuli
        ]
        self._upload_landscape(config.landscape_seed)
        try:
            drawing = self._make_drawing(config)
        except GraphicsError:
            self._offscreen.close()
            raise
        self._draw_with(drawing, config)

    def reconfigure(self, config: CameraConfig) -> None:
        """Draw as another configuration has it; the stimuli stay in the graphics memory.

        Raises GraphicsError, having changed nothing, when this machine cannot draw so.
        """
        self._offscreen.make_current()
        drawing = self._make_drawing(config)
        self._free_renderer()
        if config.landscape_seed != self._config.landscape_seed:
            self._offscreen.gl.glDeleteTextures([self._landscape_name])
            self._upload_landscape(config.landscape_seed)
        self._draw_with(drawing, config)

    def _make_drawing(self, config: CameraConfig) -> _Drawing:
        """Make a scene and a renderer of it, beside those that draw now."""
        size_px = _buffer_size_px(config)
        model = build_scene_model(config, self._eye_height_m, size_px)
        try:
            return model, mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_50)
        except mujoco.FatalError as error:
            raise GraphicsError(
                f"camera: expected pictures that fit into one buffer of OpenGL here; for "
                f"{size_px[0]} x {size_px[1]} pixels it reports: {error}"
            ) from error

    def _draw_with(self, drawing: _Drawing, config: CameraConfig) -> None:
        """Draw with these from here on."""
        self._config = config
        self._viewport = mujoco.MjrRect(0, 0, N_EYES * config.width_px, config.height_px)
        model, self._renderer = drawing
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._renderer)
        self._scene = build_scene(model)
        for camera, magnification in zip(self._scene.camera, config.magnifications, strict=True):
            set_projection(camera, config, magnification)
        self._own_textures = np.array(self._renderer.texture)
        self._renderer.texture[LANDSCAPE_GEOM] = self._landscape_name
        self._left_pictures: np.ndarray | None = None
        self._mask_what_is_not_drawn()

    def _free_renderer(self) -> None:
        # The renderer frees the textures in its slots: its own, not ours.
        self._renderer.texture[:] = self._own_textures
        self._renderer.free()

    def start(self, view: View) -> None:
        """Let the graphics hardware, or the threads that stand in for it, begin to draw."""
        self._offscreen.make_current()
        for camera, position_m, rotation in zip(
            self._scene.camera, view.eye_positions_m, view.eye_rotations, strict=True
        ):
            camera.pos, camera.forward, camera.up = position_m, rotation[:, 0], rotation[:, 2]
        self._scene.geoms[PLANE_GEOM].pos = (view.distance_m, 0.0, self._eye_height_m)
        left, right = view.i_stimuli
        self._left_pictures = None
        if left != right:  # one call draws both eyes with one stimulus: draw twice
            self._draw(left, view.distance_m)
            self._left_pictures = self._read()
        self._draw(right, view.distance_m)
        self._offscreen.gl.glFlush()

    def finish(self) -> np.ndarray:
        """Return what was started, (2, height, width) uint8."""
        pictures = self._read()
        if self._left_pictures is not None:
            pictures[0] = self._left_pictures[0]
        return pictures

    def close(self) -> None:
        """Free the graphics memory."""
        self._offscreen.make_current()
        self._free_renderer()
        self._offscreen.gl.glDeleteTextures(
            [*{name for names in self._textures for name in names}, self._landscape_name]
        )
        self._offscreen.close()

    def _upload_landscape(self, seed: int) -> None:
        self._landscape_name = upload_picture(self._offscreen.gl, landscape_picture(seed))

    def _draw(self, i_stimulus: int, distance_m: float) -> None:
        """Draw with the stimulus on the plane, at the size that suits the distance."""
        is_reduced = shows_reduced(self._config, self._sizes_px[i_stimulus], distance_m)
        self._renderer.texture[PLANE_GEOM] = self._textures[i_stimulus][is_reduced]
        mujoco.mjr_render(self._viewport, self._scene, self._renderer)

    def _mask_what_is_not_drawn(self) -> None:
        """Let the stencil buffer stop all drawing outside the region of interest, from here on.

        A smaller or shifted viewport would change the rounding of texture coordinates; a stencil
        leaves the pixels inside as they are. The renderer touches no stencil without reflections,
        and a write mask of zero keeps it from being cleared.
        """
        gl = self._offscreen.gl
        gl.glDisable(gl.GL_STENCIL_TEST)
        gl.glStencilMask(0xFF)
        if self._config.drawn_px == (self._config.width_px, self._config.height_px):
            return
        gl.glClearStencil(0)
        gl.glClear(gl.GL_STENCIL_BUFFER_BIT)
        gl.glClearStencil(1)
        gl.glEnable(gl.GL_SCISSOR_TEST)
        for i_eye in range(N_EYES):
            gl.glScissor(*self._origin_px(i_eye), *self._config.drawn_px)
            gl.glClear(gl.GL_STENCIL_BUFFER_BIT)
        gl.glDisable(gl.GL_SCISSOR_TEST)
        gl.glStencilFunc(gl.GL_EQUAL, 1, 1)
        gl.glStencilMask(0)
        gl.glEnable(gl.GL_STENCIL_TEST)

    def _origin_px(self, i_eye: int) -> tuple[int, int]:
        """Return where in the buffer one eye's drawn region starts, from its bottom left."""
        width_px, height_px = self._config.drawn_px
        return (
            i_eye * self._config.width_px + (self._config.width_px - width_px) // 2,
            (self._config.height_px - height_px) // 2,
        )

    def _read(self) -> np.ndarray:
        """Return what was drawn, (2, height, width) of the drawn region."""
        gl = self._offscreen.gl
        width_px, height_px = self._config.drawn_px
        left_px, bottom_px = self._origin_px(0)
        span_px = self._origin_px(1)[0] + width_px - left_px
        rows = np.empty((height_px, span_px), np.uint8)
        gl.glPixelStorei(gl.GL_PACK_ALIGNMENT, 1)
        gl.glReadPixels(
            left_px, bottom_px, span_px, height_px, gl.GL_RED, gl.GL_UNSIGNED_BYTE, rows
        )
        upright = rows[::-1]  # OpenGL's row 0 is at the bottom
        return np.stack((upright[:, :width_px], upright[:, span_px - width_px :]))


def _buffer_size_px(config: CameraConfig) -> tuple[int, int]:
    """Return width and height of the buffer: up to the right eye's region, and no further.

    What lies right of it and above it can be cut off without moving a pixel.
    """
    drawn_width_px, drawn_height_px = config.drawn_px
    return (
        config.width_px + (config.width_px + drawn_width_px) // 2,
        (config.height_px + drawn_height_px) // 2,
    )
