"""The messages of a head's observation, serialized."""

from collections.abc import Iterator

import numpy as np
from sensor_msgs.msg import CameraInfo, Image

from eye_plant.head.head import Head
from eye_plant.head.plant import HeadObservation
from lockstep import CommandSpace
from lockstep.optics import Pinhole
from lockstep.wire.cdr import serialized
from lockstep.wire.images import ImageBytes
from lockstep.wire.stamps import to_time
from lockstep.wire.topics import (
    CAMERA_INFOS,
    EPISODE_NAMES,
    GROUND_TRUTH_NAMES,
    JOINT_STATES,
    PICTURES,
)
from lockstep.wire.vectors import VectorBytes

_PLUMB_BOB_ENTRIES = 5


class HeadMessages:
    """Serializes observations: (topic, message) by (topic, message), each when it is asked for."""

    def __init__(self, head: Head, space: CommandSpace) -> None:
        """Lay out the messages of a head; space: of its joints."""
        self._frame_ids, self._baseline_m = head.frame_ids, head.baseline_m
        self._episode = VectorBytes(EPISODE_NAMES)
        self._truth = VectorBytes(GROUND_TRUTH_NAMES)
        self._joints = VectorBytes(space.names)
        self._pictures: dict[tuple[int, ...], list[ImageBytes]] = {}

    def vectors(self, stamp_ns: int, observation: HeadObservation) -> Iterator[tuple[str, bytes]]:
        """Yield everything small, the joints' states last: they wake whoever listens."""
        yield "episode", self._episode.of(stamp_ns, observation.episode_values())
        yield "ground_truth", self._truth.of(stamp_ns, observation.ground_truth_values())
        yield JOINT_STATES, self._joints.of(stamp_ns, observation.angles_rad)

    def pictures(self, stamp_ns: int, observation: HeadObservation) -> Iterator[tuple[str, bytes]]:
        """Yield both pictures, if there are any."""
        pictures = observation.pictures
        if pictures is None:
            return
        size = pictures.shape[1:]
        if size not in self._pictures:
            self._pictures[size] = [_picture_bytes(size, frame) for frame in self._frame_ids]
        for topic, layout, picture in zip(PICTURES, self._pictures[size], pictures, strict=True):
            yield topic, layout.of(stamp_ns, np.ascontiguousarray(picture))

    def camera_infos(
        self, stamp_ns: int, observation: HeadObservation
    ) -> Iterator[tuple[str, bytes]]:
        """Yield the calibrations that belong to the pictures."""
        if observation.pictures is None or observation.cameras is None:
            return
        size = observation.pictures.shape[1:]
        for i_eye, topic in enumerate(CAMERA_INFOS):
            info = camera_info(observation.cameras[i_eye], size, self._baseline_m * i_eye)
            info.header.frame_id = self._frame_ids[i_eye]
            info.header.stamp = to_time(stamp_ns)
            yield topic, serialized(info)


def camera_info(camera: Pinhole, shape: tuple[int, ...], aside_m: float) -> CameraInfo:
    """Return the calibration of one camera, without stamp and frame.

    shape: (height, width) of its pictures; aside_m: how far it is to the right of the left camera.
    """
    (fx, fy), (cx, cy) = camera.focal_px, camera.centre_px
    distortion = [*camera.distortion, *[0.0] * (_PLUMB_BOB_ENTRIES - len(camera.distortion))]
    return CameraInfo(
        height=shape[0],
        width=shape[1],
        distortion_model="plumb_bob"
        if len(distortion) == _PLUMB_BOB_ENTRIES
        else "rational_polynomial",
        d=distortion,
        k=[fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0],
        r=[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        p=[fx, 0.0, cx, -fx * aside_m, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0],
    )


def _picture_bytes(size: tuple[int, ...], frame_id: str) -> ImageBytes:
    height, width = size
    message = Image(height=height, width=width, encoding="mono8", step=width)
    message.header.frame_id = frame_id
    return ImageBytes(message)
