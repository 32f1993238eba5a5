"""The cost of messages: one hop between two processes, and one iteration into the bag."""

import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
from rclpy.context import Context
from rclpy.node import Node
from sensor_msgs.msg import Image, JointState

from experiment_manager.bag.reader import Bag
from experiment_manager.bag.writer import BagWriter
from experiment_manager.supervision.domains import own_domain
from eye_plant.camera.config import CameraConfig
from eye_plant.messages import picture_message
from lockstep.errors import InputError
from lockstep.node.executor import LockstepExecutor
from lockstep.node.process import run_node
from lockstep.wire.images import ImagePublisher
from lockstep.wire.qos import LOCKSTEP_QOS
from lockstep.wire.topics import PICTURES, TOPIC_TYPES
from lockstep.wire.vectors import VectorPublisher
from tests.stamps import to_ns

_NAMES = tuple(f"entry_{i}" for i in range(12))
_RESEND_S = 0.5
_LIMIT_S = 60.0


class EchoNode(Node):
    """Answers a vector, or the second of two pictures, with a vector of the same stamp."""

    def __init__(self, **kwargs: Any) -> None:
        """Create the echo."""
        super().__init__("benchmark_echo", **kwargs)
        self._answer = VectorPublisher(self, "pong", _NAMES)
        self.create_subscription(JointState, "ping", self._echo, LOCKSTEP_QOS)
        self.create_subscription(Image, PICTURES[0], lambda message: None, LOCKSTEP_QOS)
        self.create_subscription(Image, PICTURES[1], self._echo, LOCKSTEP_QOS)
        # An executor that sleeps for ever would not let Python see a SIGTERM.
        self.create_timer(_RESEND_S, lambda: None)

    def _echo(self, message: JointState | Image) -> None:
        self._answer.publish(to_ns(message.header.stamp), np.zeros(len(_NAMES)))


class PingNode(Node):
    """Sends, waits for the echo, and sends again: so often, then the durations are complete."""

    def __init__(self, n_round_trips: int, **kwargs: Any) -> None:
        """n_round_trips: of each kind, small vectors and pairs of pictures."""
        super().__init__("benchmark_ping", **kwargs)
        self.durations_s: dict[str, list[float]] = {"vector": [], "pictures": []}
        self._n = n_round_trips
        self._number = 0
        self._sent_s = time.perf_counter()
        self._vector = VectorPublisher(self, "ping", _NAMES)
        config = CameraConfig()
        self._picture = np.zeros((config.roi_height_px, config.roi_width_px), np.uint8)
        self._pictures = [
            ImagePublisher(self, topic, picture_message(config, i_eye))
            for i_eye, topic in enumerate(PICTURES)
        ]
        self.create_subscription(JointState, "pong", self._receive, LOCKSTEP_QOS)
        self.create_timer(_RESEND_S, self._resend)

    @property
    def is_done(self) -> bool:
        """Whether all round trips have been made."""
        return all(len(durations) >= self._n for durations in self.durations_s.values())

    def _resend(self) -> None:
        """Try again: what is sent before both sides have met is lost."""
        if time.perf_counter() - self._sent_s > _RESEND_S:
            self._send()

    def _send(self) -> None:
        """Send the next message: vectors and pairs of pictures take turns."""
        self._number += 1
        self._kind = min(self.durations_s, key=lambda kind: len(self.durations_s[kind]))
        self._sent_s = time.perf_counter()
        if self._kind == "vector":
            self._vector.publish(self._number, np.zeros(len(_NAMES)))
        else:
            for publisher in self._pictures:
                publisher.publish(self._number, self._picture)

    def _receive(self, message: JointState) -> None:
        if to_ns(message.header.stamp) != self._number:
            return
        self.durations_s[self._kind].append(time.perf_counter() - self._sent_s)
        if self.is_done:
            self.context.try_shutdown()
        else:
            self._send()


def hop_times_ms(n_round_trips: int) -> dict[str, float]:
    """Return median times of one hop between two processes: "vector" and "pictures" (a pair).

    A round trip with a vector is two hops; one with pictures there is a vector's hop back.
    """
    with own_domain() as domain:
        echo = subprocess.Popen(
            [sys.executable, "-m", "tests.benchmark.messages"],
            env=os.environ | {"ROS_DOMAIN_ID": str(domain)},
        )
        try:
            durations_s = _play(domain, n_round_trips)
        finally:
            echo.terminate()
            echo.wait()
    vector_s = float(np.median(durations_s["vector"])) / 2.0
    pictures_s = float(np.median(durations_s["pictures"])) - vector_s
    return {"vector": 1e3 * vector_s, "pictures": 1e3 * pictures_s}


def _play(domain: int, n_round_trips: int) -> dict[str, list[float]]:
    context = Context()
    context.init(domain_id=domain)
    node = PingNode(n_round_trips, context=context, start_parameter_services=False)
    executor = LockstepExecutor(context=context)
    executor.add_node(node)
    node.create_timer(_LIMIT_S, context.try_shutdown)
    executor.spin()
    durations_s, is_done = node.durations_s, node.is_done
    executor.shutdown()
    node.destroy_node()
    context.try_shutdown()
    if not is_done:
        raise RuntimeError(f"the echo process did not answer in {_LIMIT_S:.0f} s")
    return durations_s


def recording_ms(bag: Path, copy: Path) -> float:
    """Return the time that the bag writer takes for one iteration, compression included.

    bag: directory of a run's bag, whose messages are written again to the new directory copy. One
    iteration is what one muscle command was recorded with. Raises InputError for a bag without any.
    """
    recorded = Bag(bag)
    messages = [
        (topic, data, stamp_ns)
        for topic in filter(recorded.has, TOPIC_TYPES)
        for stamp_ns, data in recorded.messages(topic)
    ]
    messages.sort(key=lambda message: message[2])
    n_iterations = sum(topic == "muscle_command" for topic, _, _ in messages)
    if n_iterations == 0:
        raise InputError(f"{bag}: expected a bag with muscle commands, found none")
    start_s = time.perf_counter()
    with BagWriter(copy, TOPIC_TYPES, {}) as writer:
        for topic, data, stamp_ns in messages:
            writer.write(topic, data, stamp_ns)
    return 1e3 * (time.perf_counter() - start_s) / n_iterations


if __name__ == "__main__":
    sys.exit(run_node(EchoNode))
