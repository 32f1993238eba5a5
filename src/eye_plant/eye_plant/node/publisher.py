"""Publishes an observation of the plant on all its topics."""

from collections.abc import Iterable

from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import CameraInfo, Image, JointState

from eye_plant.config import EyePlantConfig
from eye_plant.messages import ObservationMessages
from eye_plant.observation import Observation
from lockstep.wire.qos import LOCKSTEP_QOS
from lockstep.wire.topics import (
    CAMERA_INFOS,
    MEAN_METABOLIC_RATES,
    PICTURES,
    PLANT_VECTORS,
    apart_pictures,
)

_TYPES = {
    **dict.fromkeys(PLANT_VECTORS, JointState),
    "/clock": Clock,
    **dict.fromkeys(PICTURES, Image),
    **dict.fromkeys(CAMERA_INFOS, CameraInfo),
    MEAN_METABOLIC_RATES: JointState,
}


class ObservationPublisher:
    """The publishers of the plant's topics."""

    def __init__(self, node: Node, config: EyePlantConfig) -> None:
        """Create the publishers on the node."""
        self._messages = ObservationMessages(config)
        apart = apart_pictures(config.scales)
        self._publishers = {
            topic: node.create_publisher(kind, topic, LOCKSTEP_QOS)
            for topic, kind in (_TYPES | dict.fromkeys(apart, Image)).items()
        }

    def reconfigure(self, config: EyePlantConfig) -> None:
        """Tell of the cameras as they are from now on."""
        self._messages = ObservationMessages(config)

    def publish(self, stamp_ns: int, observation: Observation) -> None:
        """Publish everything under one stamp.

        Camera infos and mean metabolic rates only while somebody subscribes to them.
        """
        self._send(self._messages.pictures(stamp_ns, observation))
        self._send(self._messages.apart(stamp_ns, observation))
        if self._is_read(*CAMERA_INFOS):
            self._send(self._messages.camera_infos(stamp_ns, observation))
        self._send(self._messages.vectors(stamp_ns, observation))
        if self._is_read(MEAN_METABOLIC_RATES):
            rates = self._messages.mean_metabolic_rates(stamp_ns, observation)
            self._publishers[MEAN_METABOLIC_RATES].publish(rates)

    def _is_read(self, *topics: str) -> bool:
        return any(self._publishers[topic].get_subscription_count() for topic in topics)

    def _send(self, messages: Iterable[tuple[str, bytes]]) -> None:
        for topic, message in messages:
            self._publishers[topic].publish(message)
