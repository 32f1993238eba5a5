"""The node of a robot's head: pictures and joint states out, episodes and joint commands in."""

import functools
import sys
from typing import Any

from rcl_interfaces.msg import ParameterDescriptor
from sensor_msgs.msg import CameraInfo, Image, JointState

from eye_plant.head.head import Head
from eye_plant.head.messages import HeadMessages
from eye_plant.head.plant import HeadObservation, HeadPlant
from eye_plant.node.lockstep_plant import LockstepPlant
from lockstep.node.diagnostics import Diagnostics
from lockstep.node.process import run_node
from lockstep.wire.qos import LOCKSTEP_QOS
from lockstep.wire.topics import CAMERA_INFOS, HEAD_VECTORS, JOINT_COMMAND, PICTURES

_TYPES = {
    **dict.fromkeys(PICTURES, Image),
    **dict.fromkeys(CAMERA_INFOS, CameraInfo),
    **dict.fromkeys(HEAD_VECTORS, JointState),
}


class HeadNode(LockstepPlant[HeadPlant, HeadObservation]):
    """A head; its stamps are the times of the node's clock."""

    # Its callbacks wait for motors and cameras.
    gives_way = False

    def __init__(self, head: Head, **kwargs: Any) -> None:
        """Offer the topics and the service of a plant; raises InputError for a head that cannot."""
        super().__init__("head", **kwargs)
        self.plant = HeadPlant(head)
        for name, value in (
            ("command_space", self.plant.command_space),
            ("mechanics.baseline_m", head.baseline_m),
        ):
            # The manager compares them with its own.
            descriptor = ParameterDescriptor(read_only=True)
            self.declare_parameter(name, value, descriptor, ignore_override=True)
        self.diagnostics = Diagnostics(self, self._state_of_run)
        self._messages = HeadMessages(head, self.plant.space)
        self._publishers = {
            topic: self.create_publisher(kind, topic, LOCKSTEP_QOS)
            for topic, kind in _TYPES.items()
        }
        self._wait_for_episodes(JOINT_COMMAND, {})
        self.get_logger().info(f"a head with {', '.join(self.plant.space.names)}")

    def check_episode(self, last_observation: int) -> None:
        """Accept any number of observations."""

    def stamp_ns(self, observation: HeadObservation) -> int:
        """Return the time of the node's clock, later than the last one."""
        return max(int(self.get_clock().now().nanoseconds), self._stamp_ns + 1)

    def send(self, stamp_ns: int, observation: HeadObservation) -> None:
        """Publish an observation."""
        messages = self._messages
        for send in (messages.pictures, messages.camera_infos, messages.vectors):
            for topic, message in send(stamp_ns, observation):
                self._publishers[topic].publish(message)


def run_head(head: Head) -> None:
    """Run a head as the plant of the graph until it is told to stop."""
    sys.exit(run_node(functools.partial(HeadNode, head)))
