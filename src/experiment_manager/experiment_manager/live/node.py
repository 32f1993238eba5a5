"""The node live_view: listens to the graph as a recorder does, and serves it to viewers.

It never blocks a run: it samples the topics twenty times a second, subscribes to what a client
watches, and publishes nothing but the gaze targets that people ask for.
"""

import sys
from collections import deque
from functools import partial
from typing import Any

from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.subscription import Subscription
from sensor_msgs.msg import Image, JointState

from experiment_manager.live.address import Address
from experiment_manager.live.config import LiveViewConfig
from experiment_manager.live.page import Page
from experiment_manager.live.shown import Shown
from experiment_manager.live.steering import Steering
from experiment_manager.live.view import View, open_server
from experiment_manager.run.recorded_topics import SMALL_TOPICS
from lockstep import InputError
from lockstep.node.process import run_node
from lockstep.node.ros_parameters import declare_config
from lockstep.scales import ScalesConfig
from lockstep.wire.cdr import image_array, stamp_ns_of
from lockstep.wire.topics import BASIS_FUNCTIONS, GAZE_TARGET, PICTURES, TARGET_NAMES
from lockstep.wire.vectors import VectorPublisher

# Of the ground truth each message counts; of the rest the newest is shown.
_DEPTHS = {"ground_truth": 64}
# Between two looks left and right come a moment apart: the newest that both have is shown.
_N_KEPT = 4


class LiveViewNode(Node):
    """Takes messages as they come, and shows the newest of each topic at each look."""

    gives_way = True

    def __init__(self, **kwargs: Any) -> None:
        """Listen on the configured ports; raises InputError when that cannot be."""
        super().__init__("live_view", **kwargs)
        config = declare_config(self, LiveViewConfig)
        focal_px = config.camera.focal_length_px * config.camera.left_magnification
        self._shown = Shown(focal_px, config.run)
        self._steering = Steering(self._shown)
        self._gaze_targets = VectorPublisher(self, GAZE_TARGET, TARGET_NAMES)
        self._server = open_server(config.host, config.port, self._steering.ask)
        port = self._server.port
        address = f"ws://{Address(config.host, port)}" if port else ""
        try:
            self._page = Page(config.host, config.page_port, address, self._steering)
        except InputError:
            self._server.close()
            raise
        self._view = View(self._server, config.n_selections)
        # The reconstructions are of the published model's windows.
        self._shows_code = config.scales == ScalesConfig()
        self._heard: dict[str, deque[bytes]] = {}
        self._subscribed: dict[str, Subscription] = {}
        self.create_timer(
            1.0 / config.rate_hz, self._look, clock=Clock(clock_type=ClockType.STEADY_TIME)
        )
        page = f"http://{Address(config.host, self._page.port)}/"
        viewers = f"; for viewers: {address}" if address else ""
        self.get_logger().info(f"live view at {page}{viewers}")

    @property
    def ports(self) -> tuple[int, int]:
        """Of the WebSocket server and the page."""
        return self._server.port, self._page.port

    def awaited_subscriptions(self) -> list[Subscription]:
        """Return none: no message is worth waking up for, the next look is soon."""
        return []

    def _look(self) -> None:
        try:
            self._show_newest()
            if (target_deg := self._steering.take()) is not None:
                self._gaze_targets.publish(0, target_deg)
        except InputError as error:
            self.get_logger().warning(str(error), throttle_duration_sec=10.0)
        of_page = set(PICTURES) if self._shown.is_watched else set()
        self._subscribe(self._view.wanted_topics() | of_page)

    def _show_newest(self) -> None:
        heard, self._heard = self._heard, {}
        for message in heard.get("ground_truth", ()):
            self._view.count(message)
        if BASIS_FUNCTIONS in heard and self._shows_code:
            self._view.take_basis_functions(image_array(heard.pop(BASIS_FUNCTIONS)[-1]))
        newest = {topic: messages[-1] for topic, messages in heard.items()}
        left, right = ({stamp_ns_of(m): m for m in heard.get(t, ())} for t in PICTURES)
        if common := set(left) & set(right):
            newest |= dict(zip(PICTURES, (left[max(common)], right[max(common)]), strict=True))
        elif left and right:
            del newest[PICTURES[0]], newest[PICTURES[1]]
        if self._shown.is_watched and PICTURES[0] in newest:
            self._shown.show([image_array(newest[t]) for t in PICTURES if t in newest])
        self._view.show(newest)
        if self._view.learning is not None:
            self._shown.learn(*self._view.learning)

    def _subscribe(self, wanted: set[str]) -> None:
        for topic in wanted - set(self._subscribed):
            kind = JointState if topic in SMALL_TOPICS else Image
            depth = _DEPTHS.get(topic, _N_KEPT)
            # No publisher keeps or sends anything again for a reader of this quality of service.
            qos = QoSProfile(depth=depth, reliability=ReliabilityPolicy.BEST_EFFORT)
            self._subscribed[topic] = self.create_subscription(
                kind, topic, partial(self._hear, topic, depth), qos, raw=True
            )
        for topic in set(self._subscribed) - wanted:
            self.destroy_subscription(self._subscribed.pop(topic))

    def _hear(self, topic: str, depth: int, message: bytes) -> None:
        self._heard.setdefault(topic, deque(maxlen=depth)).append(message)

    def destroy_node(self) -> None:
        """Stop serving with the node."""
        self._page.close()
        self._server.close()
        super().destroy_node()


def main() -> None:
    """Run the node until it is told to stop."""
    sys.exit(run_node(LiveViewNode))


if __name__ == "__main__":
    main()
