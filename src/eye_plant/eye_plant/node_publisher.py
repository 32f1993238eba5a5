"""Publishes an observation of the plant on all its topics."""

import numpy as np
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import CameraInfo

from eye_plant.config import EyePlantConfig
from eye_plant.mechanics.muscles import MUSCLE_NAMES
from eye_plant.messages import camera_info, picture_message
from eye_plant.observation import Observation
from lockstep.images import ImagePublisher
from lockstep.qos import LOCKSTEP_QOS
from lockstep.stamps import to_time
from lockstep.topics import EPISODE_NAMES, EYE_STATE_NAMES, GROUND_TRUTH_NAMES, SIDES
from lockstep.vectors import VectorPublisher


class ObservationPublisher:
    """The publishers of the plant's topics."""

    def __init__(self, node: Node, config: EyePlantConfig) -> None:
        """Create the publishers on the node."""
        self._episode = VectorPublisher(node, "episode", EPISODE_NAMES)
        self._activations = VectorPublisher(node, "muscle_activations", MUSCLE_NAMES)
        self._muscles = VectorPublisher(node, "muscle_states", MUSCLE_NAMES)
        self._eyes = VectorPublisher(node, "eye_states", EYE_STATE_NAMES)
        self._truth = VectorPublisher(node, "ground_truth", GROUND_TRUTH_NAMES)
        self._clock = node.create_publisher(Clock, "/clock", LOCKSTEP_QOS)
        self._pictures = [
            ImagePublisher(node, f"{side}/image_raw", picture_message(config.camera, i_eye))
            for i_eye, side in enumerate(SIDES)
        ]
        self._infos = [
            node.create_publisher(CameraInfo, f"{side}/camera_info", LOCKSTEP_QOS) for side in SIDES
        ]
        self._info_messages = [
            camera_info(config.camera, i_eye, config.mechanics.baseline_m) for i_eye in range(2)
        ]

    def publish(self, stamp_ns: int, observation: Observation) -> None:
        """Publish everything under one stamp.

        What the next answer needs goes first, the activations last of it: they wake the coder. The
        rest is sent while others already compute, the eyes' states last: they wake the recorder.
        """
        state = observation.state
        if observation.pictures is not None:
            self._publish_pictures(stamp_ns, observation.pictures)
        self._episode.publish(stamp_ns, observation.episode_values())
        self._activations.publish(
            stamp_ns, state.activations, state.mean_metabolic_rate_w, state.metabolic_rate_w
        )
        self._truth.publish(stamp_ns, observation.ground_truth_values())
        self._muscles.publish(stamp_ns, state.lengths_m, state.velocities_m_s, state.forces_n)
        self._clock.publish(Clock(clock=to_time(stamp_ns)))
        self._eyes.publish(
            stamp_ns, state.eye_angles_rad.ravel(), state.eye_velocities_rad_s.ravel()
        )

    def _publish_pictures(self, stamp_ns: int, pictures: np.ndarray) -> None:
        for pictures_of_eye, picture in zip(self._pictures, pictures, strict=True):
            pictures_of_eye.publish(stamp_ns, picture)
        for publisher, info in zip(self._infos, self._info_messages, strict=True):
            if publisher.get_subscription_count():
                info.header.stamp = to_time(stamp_ns)
                publisher.publish(info)
