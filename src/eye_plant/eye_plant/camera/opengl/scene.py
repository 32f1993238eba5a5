"""The scene of K17: a textured plane straight ahead, and a landscape on a wall behind it.

The scene is a MuJoCo model of its own, without the eyes: the camera needs no more of the plant than
the eyes' poses. World frame: x forward, y left, z up, origin on the ground between the eyes.
"""

import mujoco

from eye_plant.camera.config import CameraConfig
from eye_plant.camera.renderer import FAR_M, NEAR_M

# Nearest first: what an earlier geom hides need not be shaded.
PLANE_GEOM = 0
LANDSCAPE_GEOM = 1

# Both surfaces face the eyes: their own x, a texture's right, is -y, their own y is up.
_FACING_EYES_QUAT = (0.5, 0.5, -0.5, -0.5)


def build_scene_model(
    config: CameraConfig, eye_height_m: float, buffer_size_px: tuple[int, int]
) -> mujoco.MjModel:
    """Return the model to render: two unlit geoms, each with a texture slot of its own.

    Texture i belongs to geom i; the slots hold one pixel each until real textures are bound. Both
    geoms' centres are at eye height. White that emits, without any light, leaves a texture's values
    as they are. buffer_size_px: width and height of the off-screen buffer.
    """
    spec = mujoco.MjSpec()
    spec.visual.headlight.active = 0
    spec.visual.quality.offsamples = 0
    spec.visual.quality.shadowsize = 0
    spec.visual.global_.offwidth, spec.visual.global_.offheight = buffer_size_px
    plane_m = config.plane_size_m
    _add_surface(spec, "plane", (plane_m, plane_m), (1.0, 0.0, eye_height_m))
    _add_surface(
        spec,
        "landscape",
        (config.landscape_width_m, config.landscape_height_m),
        (config.landscape_distance_m, 0.0, eye_height_m),
    )
    return spec.compile()


def _add_surface(
    spec: mujoco.MjSpec,
    name: str,
    size_m: tuple[float, float],
    position_m: tuple[float, float, float],
) -> None:
    spec.add_texture(
        name=name,
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_FLAT,
        rgb1=[1.0, 1.0, 1.0],
        width=1,
        height=1,
    )
    material = spec.add_material(
        name=name, rgba=[1.0, 1.0, 1.0, 1.0], emission=1.0, specular=0.0, shininess=0.0
    )
    material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = name
    spec.worldbody.add_geom(
        name=name,
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        # The third size is the spacing of the grid it is drawn as: one quad.
        size=[size_m[0] / 2.0, size_m[1] / 2.0, max(size_m)],
        pos=position_m,
        quat=_FACING_EYES_QUAT,
        material=name,
    )


def build_scene(model: mujoco.MjModel) -> mujoco.MjvScene:
    """Return the model's geoms, drawn for both eyes side by side, no lights, no effects."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    scene = mujoco.MjvScene(model, model.ngeom)
    mujoco.mjv_updateScene(
        model, data, mujoco.MjvOption(), None, mujoco.MjvCamera(), mujoco.mjtCatBit.mjCAT_ALL, scene
    )
    scene.nlight = 0
    scene.flags[:] = 0
    scene.stereo = mujoco.mjtStereo.mjSTEREO_SIDEBYSIDE
    return scene


def set_projection(camera: mujoco.MjvGLCamera, config: CameraConfig, magnification: float) -> None:
    """Give one eye's camera the focal length of config times magnification, axis in the centre.

    The frustum's half height at the near plane is near * (height / 2) / F; the renderer derives its
    width from the picture's.
    """
    focal_length_px = config.focal_length_px * magnification
    half_height_m = NEAR_M * (config.height_px / 2.0) / focal_length_px
    camera.frustum_near = NEAR_M
    camera.frustum_far = FAR_M
    camera.frustum_bottom = -half_height_m
    camera.frustum_top = half_height_m
    camera.frustum_center = 0.0
