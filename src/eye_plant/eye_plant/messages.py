"""The messages of an observation, serialized, and those of each eye's camera."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import product

from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import CameraInfo, Image

from eye_plant.camera.config import CameraConfig
from eye_plant.config import EyePlantConfig
from eye_plant.observation import Observation
from lockstep import MUSCLE_NAMES, SIDES
from lockstep.scales import Scale
from lockstep.wire.cdr import serialized
from lockstep.wire.codec import Writer
from lockstep.wire.images import ImageBytes
from lockstep.wire.stamps import to_time
from lockstep.wire.topics import (
    CAMERA_INFOS,
    EPISODE_NAMES,
    GIVEN_TARGET_NAMES,
    GROUND_TRUTH_NAMES,
    PICTURES,
    apart_pictures,
    eye_state_names,
)
from lockstep.wire.vectors import VectorBytes


class ObservationMessages:
    """Serializes observations: (topic, message) by (topic, message), each when it is asked for."""

    def __init__(self, config: EyePlantConfig) -> None:
        """Lay out the messages of a plant of that configuration."""
        self._episode = VectorBytes(EPISODE_NAMES)
        self._episode_with_target = VectorBytes((*EPISODE_NAMES, *GIVEN_TARGET_NAMES))
        self._muscles = VectorBytes(MUSCLE_NAMES)
        self._activations = VectorBytes(config.space.activation_names)
        self._feels_noise = config.noise.is_of_activations
        self._eyes = VectorBytes(eye_state_names(config.space))
        self._truth = VectorBytes(GROUND_TRUTH_NAMES)
        self._pictures = [ImageBytes(picture_message(config.camera, i_eye)) for i_eye in range(2)]
        self._apart = [
            (topic, ImageBytes(_of_scale(config.camera, scale, i_eye)))
            for topic, (scale, i_eye) in zip(
                apart_pictures(config.scales), product(config.scales.apart, range(2)), strict=True
            )
        ]
        baseline_m = config.mechanics.baseline_m
        self._infos = [Writer(camera_info(config.camera, i_eye, baseline_m)) for i_eye in range(2)]

    def vectors(self, stamp_ns: int, observation: Observation) -> Iterator[tuple[str, bytes]]:
        """Yield everything small.

        What the next answer needs comes first, the activations last of it: they wake the coder.
        The rest is sent while others already compute, the eyes' states last: they wake the
        recorder.
        """
        state = observation.state
        if observation.episode.n_targets:
            values = (*observation.episode_values(), *observation.given_target_deg)
            yield "episode", self._episode_with_target.of(stamp_ns, values)
        else:
            yield "episode", self._episode.of(stamp_ns, observation.episode_values())
        felt = observation.felt if self._feels_noise else ()
        yield (
            "muscle_activations",
            self._activations.of(stamp_ns, observation.activations, felt, observation.all_rates_w),
        )
        yield "ground_truth", self._truth.of(stamp_ns, observation.ground_truth_values())
        yield (
            "muscle_states",
            self._muscles.of(stamp_ns, state.lengths_m, state.velocities_m_s, state.forces_n),
        )
        yield "/clock", serialized(Clock(clock=to_time(stamp_ns)))
        yield (
            "eye_states",
            self._eyes.of(stamp_ns, *observation.eye_state_values()),
        )

    def mean_metabolic_rates(self, stamp_ns: int, observation: Observation) -> bytes:
        """Return what the muscles took over the control period, transients and work included.

        Of eyes that run free or move at once it is their settled rate.
        """
        return self._muscles.of(stamp_ns, observation.state.mean_metabolic_rate_w)

    def pictures(self, stamp_ns: int, observation: Observation) -> Iterator[tuple[str, bytes]]:
        """Yield both pictures, if there are any."""
        if observation.pictures is None:
            return
        for topic, layout, picture in zip(
            PICTURES, self._pictures, observation.pictures, strict=True
        ):
            yield topic, layout.of(stamp_ns, picture)

    def apart(self, stamp_ns: int, observation: Observation) -> Iterator[tuple[str, bytes]]:
        """Yield the pictures that scales have apart, if there are any; they are not recorded."""
        pictures = [picture for pair in observation.apart for picture in pair]
        for (topic, layout), picture in zip(self._apart, pictures, strict=False):
            yield topic, layout.of(stamp_ns, picture)

    def camera_infos(self, stamp_ns: int, observation: Observation) -> Iterator[tuple[str, bytes]]:
        """Yield the intrinsics that belong to the pictures, if there are any."""
        if observation.pictures is None:
            return
        for topic, write in zip(CAMERA_INFOS, self._infos, strict=True):
            yield topic, write(stamp_ns)


def camera_info(config: CameraConfig, i_eye: int, baseline_m: float) -> CameraInfo:
    """Return the intrinsics of one eye's ideal pinhole camera (0 left, 1 right), without a stamp.

    The principal point is the picture's centre between pixels, (width - 1) / 2 counting from pixel
    centres; the projection matrix names the baseline as for straight-ahead gaze (Tx = -F b for the
    right eye). A region of interest is announced as cameras do.
    """
    focal_px = config.focal_length_px * config.magnifications[i_eye]
    cx, cy = (config.width_px - 1) / 2.0, (config.height_px - 1) / 2.0
    tx = -focal_px * baseline_m * i_eye
    info = CameraInfo(
        height=config.height_px,
        width=config.width_px,
        distortion_model="plumb_bob",
        d=[0.0] * 5,
        k=[focal_px, 0.0, cx, 0.0, focal_px, cy, 0.0, 0.0, 1.0],
        r=[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        p=[focal_px, 0.0, cx, tx, 0.0, focal_px, cy, 0.0, 0.0, 0.0, 1.0, 0.0],
    )
    info.header.frame_id = f"{SIDES[i_eye]}_eye"
    if (config.roi_width_px, config.roi_height_px) != (config.width_px, config.height_px):
        info.roi.x_offset = (config.width_px - config.roi_width_px) // 2
        info.roi.y_offset = (config.height_px - config.roi_height_px) // 2
        info.roi.width, info.roi.height = config.roi_width_px, config.roi_height_px
    return info


def picture_message(config: CameraConfig, i_eye: int) -> Image:
    """Return the mono8 message of one eye's pictures, without stamp and data."""
    message = Image(
        height=config.roi_height_px,
        width=config.roi_width_px,
        encoding="mono8",
        step=config.roi_width_px,
    )
    message.header.frame_id = f"{SIDES[i_eye]}_eye"
    return message


def _of_scale(config: CameraConfig, scale: Scale, i_eye: int) -> Image:
    size_px = scale.window_px
    return picture_message(replace(config, roi_width_px=size_px, roi_height_px=size_px), i_eye)
