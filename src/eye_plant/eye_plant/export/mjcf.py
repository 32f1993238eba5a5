"""The plant's MuJoCo model and what a viewer wants: colours, cameras, a pose."""

import mujoco
import numpy as np

from eye_plant.camera.config import CameraConfig
from eye_plant.mechanics.mujoco_model import MechanicsConfig, build_spec
from eye_plant.mechanics.oculomotor import Oculomotor
from lockstep import SIDES

KEYFRAME = "tonic"
# Off, as it is without being named. Only MuJoCo 4 knows it, so that older ones refuse the file:
# their tendons wrap the long way round the globe, and eyes turn tens of degrees too far.
_GUARD = 'speculative="disable"'
_WHITE, _PUPIL, _MUSCLE = (0.95, 0.95, 0.92, 1.0), (0.1, 0.15, 0.3, 1.0), (0.8, 0.25, 0.2, 1.0)
_SEEN, _HIDDEN = 0, 4
_PUPIL_RADIUS_M = 0.004
# MuJoCo's cameras look along -z with y up; an eye looks along x with z up.
_AXES_OF_CAMERA = (0.0, -1.0, 0.0, 0.0, 0.0, 1.0)


def mjcf(config: MechanicsConfig) -> str:
    """Return the MJCF of both eyes, with their palsies and surgery.

    Mechanics are those of `build_spec`, to the six digits that MuJoCo writes. Added are colours, a
    pupil and a camera per eye, a light, the keyframe of the equilibrium at tonic activations, and a
    flag that MuJoCo before 4.0 refuses.
    """
    spec = build_spec(config)
    _make_visible(spec)
    for side in SIDES:
        _add_pupil_and_camera(spec, side, config.parameters.orbit.globe_radius_m)
    spec.worldbody.add_light(pos=[1.0, 0.0, config.eye_height_m + 1.0], dir=[-1.0, 0.0, -1.0])
    spec.stat.center = [0.0, 0.0, config.eye_height_m]
    spec.stat.extent = 2.0 * config.baseline_m
    eyes = Oculomotor(config)
    spec.add_key(name=KEYFRAME, qpos=eyes.data.qpos, act=eyes.data.act, ctrl=eyes.data.ctrl)
    spec.compile()
    before, flag, after = spec.to_xml().partition("<flag ")
    return f"{before}{flag}{_GUARD} {after}"


def _make_visible(spec: mujoco.MjSpec) -> None:
    for geom in spec.geoms:
        geom.group = _SEEN if geom.name.endswith("_globe") else _HIDDEN
        geom.rgba = _WHITE
    for tendon in spec.tendons:
        tendon.group = _SEEN
        tendon.width = 0.001
        tendon.rgba = _MUSCLE
    for actuator in spec.actuators:
        actuator.group = _SEEN


def _add_pupil_and_camera(spec: mujoco.MjSpec, side: str, globe_radius_m: float) -> None:
    eye = spec.body(f"{side}_eye")
    eye.add_geom(
        name=f"{side}_pupil",
        type=mujoco.mjtGeom.mjGEOM_ELLIPSOID,
        pos=[globe_radius_m, 0.0, 0.0],
        size=[0.1 * _PUPIL_RADIUS_M, _PUPIL_RADIUS_M, _PUPIL_RADIUS_M],
        rgba=_PUPIL,
        mass=0.0,
        contype=0,
        conaffinity=0,
        group=_SEEN,
    )
    camera = CameraConfig()
    seen = eye.add_camera(
        name=f"{side}_eye",
        fovy=float(np.degrees(2.0 * np.arctan(camera.height_px / 2.0 / camera.focal_length_px))),
    )
    seen.alt.type = mujoco.mjtOrientation.mjORIENTATION_XYAXES
    seen.alt.xyaxes = _AXES_OF_CAMERA
