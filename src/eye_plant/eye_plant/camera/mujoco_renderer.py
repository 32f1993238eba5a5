"""Both eyes' pictures by MuJoCo's own renderer, through OpenGL: the oracle of the ray caster."""

import os
from collections.abc import Sequence
from typing import ClassVar

import mujoco
import numpy as np

from eye_plant.camera.config import CameraConfig
from eye_plant.camera.landscape import landscape_picture
from eye_plant.camera.renderer import FAR_M, N_EYES, NEAR_M, View
from lockstep import SIDES, InputError

# Both surfaces face the eyes: their own x, a texture's right, is -y, their own y is up.
_FACING_EYES_QUAT = (0.5, 0.5, -0.5, -0.5)


class MujocoRenderer:
    """Draws a MuJoCo model of the scene with `mujoco.Renderer`, in full, and crops the pictures.

    Simple rather than fast: MuJoCo's textures have three bytes per pixel and several copies, 6 GB
    for 140 stimuli of 1920 x 1920. So the model holds the stimuli of one view, and is made again,
    in half a second, for another one. OpenGL mixes two mip-map levels in each pixel where
    PlaneRenderer takes one: where textures are detailed, pictures of both differ.

    MuJoCo loads the OpenGL that the environment variable MUJOCO_GL names (egl, osmesa or glfw) when
    it is imported. A context is made at the first draw, in the process and thread that draw; copies
    make one of their own. What OpenGL has begun in a process does not work in its forks.
    """

    _processes: ClassVar[set[int]] = set()  # that have drawn, or are forks of one that has

    def __init__(
        self, config: CameraConfig, eye_height_m: float, stimuli: Sequence[np.ndarray]
    ) -> None:
        """Keep what is to be drawn; the arguments are those that StereoCamera takes."""
        self._config = config
        self._eye_height_m = eye_height_m
        self._stimuli = stimuli
        self._i_stimuli: tuple[int, int] | None = None
        self._renderer: mujoco.Renderer | None = None

    def __reduce__(self) -> tuple[object, ...]:
        """Copy and pickle without the context."""
        return MujocoRenderer, (self._config, self._eye_height_m, self._stimuli)

    def reconfigure(self, config: CameraConfig) -> None:
        """Draw as another configuration has it; the stimuli stay."""
        self.close()
        self._config = config

    def draw(self, view: View) -> np.ndarray:
        """Return both eyes' pictures; raises InputError when this machine cannot draw."""
        if self._renderer is None or view.i_stimuli != self._i_stimuli:
            self.close()
            self._renderer = self._make_renderer(view.i_stimuli)
            self._i_stimuli = view.i_stimuli
            self._data = mujoco.MjData(self._renderer.model)
            mujoco.mj_forward(self._renderer.model, self._data)
        self._data.geom("plane").xpos[0] = view.distance_m
        return np.stack([self._draw_eye(self._renderer, i, view) for i in range(N_EYES)])

    def close(self) -> None:
        """Free the context and the graphics memory."""
        if self._renderer is not None:
            self._renderer.close()
        self._renderer = None

    def _draw_eye(self, renderer: mujoco.Renderer, i_eye: int, view: View) -> np.ndarray:
        forward, left, up = view.eye_rotations[i_eye].T
        camera, material = self._data.camera(i_eye), renderer.model.material(SIDES[i_eye])
        camera.xpos[:] = view.eye_positions_m[i_eye]
        camera.xmat[:] = np.column_stack((-left, up, -forward)).ravel()  # it looks along its -z
        renderer.model.geom("plane").matid[:] = material.id
        renderer.update_scene(self._data, i_eye)
        renderer.scene.flags[:] = 0  # no shadows, reflections or haze
        width_px, height_px = self._config.drawn_px
        left_px = (self._config.width_px - width_px) // 2
        top_px = (self._config.height_px - height_px) // 2
        picture: np.ndarray = renderer.render()
        return picture[top_px : top_px + height_px, left_px : left_px + width_px, 0]

    def _make_renderer(self, i_stimuli: tuple[int, int]) -> mujoco.Renderer:
        width_px, height_px = self._config.width_px, self._config.height_px
        if self._processes - {os.getpid()}:
            raise InputError(
                "camera.renderer mujoco: expected a process of its own, got a fork of one that has"
                " drawn, in which OpenGL would hang; start processes by spawn or forkserver, or use"
                " camera.renderer plane"
            )
        model = self._scene(i_stimuli).compile()
        try:
            made = mujoco.Renderer(model, height_px, width_px)
        except Exception as error:  # the backends' failures have no common class
            raise InputError(
                f"camera.renderer mujoco: OpenGL cannot draw {width_px} x {height_px} pixels here"
                f" ({type(error).__name__}: {error}); set MUJOCO_GL=egl and install, for instance,"
                " libegl1 and libgl1-mesa-dri, or use camera.renderer plane, which needs no OpenGL"
            ) from error
        self._processes.add(os.getpid())
        return made

    def _scene(self, i_stimuli: tuple[int, int]) -> mujoco.MjSpec:
        """Return the plane, the landscape and a camera per eye; nothing but the textures shines.

        World frame: x forward, y left, z up, origin on the ground between the eyes.
        """
        config = self._config
        spec = mujoco.MjSpec()
        spec.visual.global_.offwidth = config.width_px
        spec.visual.global_.offheight = config.height_px
        spec.stat.extent = 1.0  # m, the unit of the next line
        spec.visual.map.znear, spec.visual.map.zfar = NEAR_M, FAR_M
        spec.visual.headlight.active = 0
        spec.visual.quality.offsamples = 0
        for side, i_stimulus in zip(SIDES, i_stimuli, strict=True):
            _add_material(spec, side, self._stimuli[i_stimulus])
        _add_material(spec, "landscape", landscape_picture(config.landscape_seed))
        plane_m = config.plane_size_m
        landscape_m = config.landscape_width_m, config.landscape_height_m
        for name, material, size_m, distance_m in (
            ("plane", SIDES[0], (plane_m, plane_m), 1.0),
            ("landscape", "landscape", landscape_m, config.landscape_distance_m),
        ):
            spec.worldbody.add_geom(
                name=name,
                type=mujoco.mjtGeom.mjGEOM_PLANE,
                # The third size is the spacing of the grid it is drawn as: one quad.
                size=[size_m[0] / 2.0, size_m[1] / 2.0, max(size_m)],
                pos=(distance_m, 0.0, self._eye_height_m),
                quat=_FACING_EYES_QUAT,
                material=material,
            )
        for magnification in config.magnifications:
            half_height = config.height_px / 2.0 / (config.focal_length_px * magnification)
            spec.worldbody.add_camera(fovy=2.0 * np.degrees(np.arctan(half_height)))
        return spec


def _add_material(spec: mujoco.MjSpec, name: str, picture: np.ndarray) -> None:
    """Add a material that shows a grey picture (height, width) uint8 as it is, row 0 on top."""
    height_px, width_px = picture.shape
    texture = spec.add_texture(
        name=name,
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        width=width_px,
        height=height_px,
        nchannel=3,
    )
    texture.data = np.repeat(picture, 3).tobytes()
    material = spec.add_material(name=name, emission=1.0, specular=0.0, shininess=0.0)
    material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = name
