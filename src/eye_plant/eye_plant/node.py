"""The node eye_plant: pictures and muscle states out, episodes and muscle commands in."""

import array
import sys
from typing import Any

import numpy as np
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rosgraph_msgs.msg import Clock as ClockMessage
from sensor_msgs.msg import CameraInfo, Image, JointState

from eye_plant.config import EyePlantConfig
from eye_plant.episode import Episode
from eye_plant.messages import camera_info, picture_message
from eye_plant.observation import Observation
from eye_plant.plant import EyePlant
from lockstep.diagnostics import Diagnostics
from lockstep.errors import InputError
from lockstep.parameters import declare_config
from lockstep.process import run_node
from lockstep.qos import LOCKSTEP_QOS
from lockstep.requests import END_RUN, START_RUN, RequestServer
from lockstep.stamps import period_ns, to_ns, to_time
from lockstep.topics import EPISODE_NAMES, EYE_STATE_NAMES, GROUND_TRUTH_NAMES, SIDES
from lockstep.vectors import VectorPublisher, values_of

REPEAT_PERIOD_S = 1.0


class EyePlantNode(Node):
    """Publishes an observation, waits for the command that answers it, executes, and so on."""

    def __init__(self, **kwargs: Any) -> None:
        """Set up the plant; raises InputError when its configuration cannot be met."""
        super().__init__("eye_plant", **kwargs)
        config = declare_config(self, EyePlantConfig)
        self._plant = EyePlant(config)
        self._period_ns = period_ns(config.mechanics.period_s)
        self._observation: Observation | None = None
        self._diagnostics = Diagnostics(self, self._state_of_run)
        self._create_publishers(config)
        self.create_subscription(JointState, "muscle_command", self._command, LOCKSTEP_QOS)
        self._requests = RequestServer(
            self,
            self._diagnostics,
            {START_RUN: self._start_run, "episode": self._begin, END_RUN: self._end_run},
        )
        self._repeat_timer = self.create_timer(
            REPEAT_PERIOD_S, self._repeat, clock=Clock(clock_type=ClockType.STEADY_TIME)
        )
        self.get_logger().info(
            f"{self._plant.n_stimuli} stimuli resident, {config.mechanics.parameter_set} eyes"
        )

    def _create_publishers(self, config: EyePlantConfig) -> None:
        muscle_names = self._plant.oculomotor.muscle_names
        self._episode = VectorPublisher(self, "episode", EPISODE_NAMES)
        self._activations = VectorPublisher(self, "muscle_activations", muscle_names)
        self._muscles = VectorPublisher(self, "muscle_states", muscle_names)
        self._eyes = VectorPublisher(self, "eye_states", EYE_STATE_NAMES)
        self._truth = VectorPublisher(self, "ground_truth", GROUND_TRUTH_NAMES)
        self._simulated_time = self.create_publisher(ClockMessage, "/clock", LOCKSTEP_QOS)
        self._pictures = [
            self.create_publisher(Image, f"{side}/image_raw", LOCKSTEP_QOS) for side in SIDES
        ]
        self._infos = [
            self.create_publisher(CameraInfo, f"{side}/camera_info", LOCKSTEP_QOS) for side in SIDES
        ]
        self._info_messages = [
            camera_info(config.camera, i_eye, config.mechanics.baseline_m) for i_eye in range(2)
        ]
        self._picture_messages = [picture_message(config.camera, i_eye) for i_eye in range(2)]

    def _start_run(self, arguments: dict[str, Any]) -> None:
        if arguments:
            raise InputError(f"{START_RUN}: expected no arguments, got {', '.join(arguments)}")
        self._observation = None

    def _end_run(self, arguments: dict[str, Any]) -> None:
        self._observation = None

    def _begin(self, arguments: dict[str, Any]) -> None:
        self._publish(self._plant.begin(Episode.from_arguments(arguments)))

    def _command(self, message: JointState) -> None:
        observation = self._observation
        stamp_ns = to_ns(message.header.stamp)
        if observation is None or not self._plant.is_waiting:
            # The repeated answer to an observation that is over is no fault.
            return
        expected_ns = observation.number * self._period_ns
        if stamp_ns < expected_ns:
            return
        try:
            if stamp_ns > expected_ns:
                raise InputError(
                    f"muscle_command: expected the stamp of the observation it answers, "
                    f"{expected_ns} ns, got {stamp_ns} ns"
                )
            values = values_of(message, message.name, "muscle_command")
            targets = self._plant.targets(message.name, values)
        except InputError as error:
            self._diagnostics.refuse(str(error))
            return
        self._publish(self._plant.execute(targets))

    def _publish(self, observation: Observation) -> None:
        self._observation = observation
        self._diagnostics.count()
        self._repeat_timer.reset()
        self._send(observation)

    def _repeat(self) -> None:
        if self._observation is not None:
            self._send(self._observation)

    def _send(self, observation: Observation) -> None:
        # What the next answer needs goes first; the rest is sent while others already compute.
        stamp_ns = observation.number * self._period_ns
        state = observation.state
        self._episode.publish(stamp_ns, observation.episode_values())
        self._activations.publish(stamp_ns, state.activations, effort=state.metabolic_rate_w)
        if observation.pictures is not None:
            self._send_pictures(stamp_ns, observation.pictures)
        self._truth.publish(stamp_ns, observation.ground_truth_values())
        self._muscles.publish(stamp_ns, state.lengths_m, state.velocities_m_s, state.forces_n)
        self._eyes.publish(
            stamp_ns, state.eye_angles_rad.ravel(), state.eye_velocities_rad_s.ravel()
        )
        self._simulated_time.publish(ClockMessage(clock=to_time(stamp_ns)))

    def _send_pictures(self, stamp_ns: int, pictures: np.ndarray) -> None:
        for publisher, message, picture in zip(
            self._pictures, self._picture_messages, pictures, strict=True
        ):
            message.header.stamp = to_time(stamp_ns)
            message.data = array.array("B", picture.tobytes())
            publisher.publish(message)
        for info_publisher, info in zip(self._infos, self._info_messages, strict=True):
            if info_publisher.get_subscription_count():
                info.header.stamp = to_time(stamp_ns)
                info_publisher.publish(info)

    def _state_of_run(self) -> dict[str, str]:
        if self._observation is None:
            return {"state": "waiting for an episode"}
        return {"state": "in an episode", "observation": str(self._observation.number)}

    def destroy_node(self) -> None:
        """Release the graphics context with the node."""
        self._plant.close()
        super().destroy_node()


def main() -> None:
    """Run the node until it is told to stop."""
    sys.exit(run_node(EyePlantNode))


if __name__ == "__main__":
    main()
