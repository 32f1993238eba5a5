"""The node eye_plant: pictures and muscle states out, episodes and muscle commands in."""

import sys
from typing import Any

from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from sensor_msgs.msg import JointState

from eye_plant.config import EyePlantConfig
from eye_plant.episode import Episode
from eye_plant.node.free_running import FreeRunning
from eye_plant.node.publisher import ObservationPublisher
from eye_plant.observation import Observation
from eye_plant.plant import EyePlant
from lockstep import InputError
from lockstep.node.diagnostics import Diagnostics
from lockstep.node.process import run_node
from lockstep.node.requests import END_RUN, RECONFIGURE, START_RUN, Arguments, RequestServer
from lockstep.node.ros_parameters import declare_config
from lockstep.wire.cdr import stamp_ns_of
from lockstep.wire.codec import Reader
from lockstep.wire.qos import LOCKSTEP_QOS
from lockstep.wire.stamps import check_stamp, period_ns
from lockstep.wire.vectors import values_of

REPEAT_PERIOD_S = 1.0


class EyePlantNode(Node):
    """Publishes an observation, waits for the command that answers it, executes, and so on.

    With `free_running.rate_hz` above 0 it waits for nobody; see `FreeRunning`.
    """

    def __init__(self, **kwargs: Any) -> None:
        """Set up the plant; raises InputError when its configuration cannot be met."""
        super().__init__("eye_plant", **kwargs)
        config = declare_config(self, EyePlantConfig)
        self._plant = EyePlant(config)
        self._period_ns = period_ns(config.mechanics.period_s)
        self._observation: Observation | None = None
        is_free = config.free_running.rate_hz > 0.0
        # In lockstep what it receives can wait until the sender's turn is over.
        self.gives_way = not is_free
        self.diagnostics = Diagnostics(
            self, (lambda: {"state": "free running"}) if is_free else self._state_of_run
        )
        self._publisher = ObservationPublisher(self, config)
        self.get_logger().info(
            f"{self._plant.n_stimuli} stimuli resident, {config.mechanics.parameter_set} eyes"
        )
        if is_free:
            self._free_running = FreeRunning(
                self, config, self._plant, self._publisher, self.diagnostics
            )
        else:
            self._wait_for_episodes()

    def _wait_for_episodes(self) -> None:
        self._read = Reader(JointState, "muscle_command")
        self.create_subscription(
            JointState, "muscle_command", self._command, LOCKSTEP_QOS, raw=True
        )
        self._requests = RequestServer(
            self,
            self.diagnostics,
            {
                START_RUN: self._start_run,
                RECONFIGURE: self._reconfigure,
                "episode": self._begin,
                END_RUN: self._end_run,
            },
        )
        self._repeat_timer = self.create_timer(
            REPEAT_PERIOD_S, self._repeat, clock=Clock(clock_type=ClockType.STEADY_TIME)
        )

    def _start_run(self, _: Arguments) -> None:
        self._observation = None
        self._reconfigure({})

    def _reconfigure(self, arguments: Arguments) -> None:
        """Take over other settings for the episodes to come; {} are those of the start."""
        if self._observation is not None and self._plant.is_waiting:
            raise InputError(
                f"{RECONFIGURE}: expected between episodes, got during one, at observation "
                f"{self._observation.number}"
            )
        self._plant.reconfigure(arguments)
        self._publisher.reconfigure(self._plant.config)

    def _end_run(self, _: Arguments) -> None:
        self._observation = None

    def _begin(self, arguments: Arguments) -> None:
        episode = Episode.from_arguments(arguments)
        check_stamp(episode.first_observation + episode.n_iterations, self._period_ns)
        self._publish(self._plant.begin(episode))

    def _command(self, data: bytes) -> None:
        observation = self._observation
        if observation is None or not self._plant.is_waiting:
            # The repeated answer to an observation that is over is no fault.
            return
        expected_ns = observation.number * self._period_ns
        try:
            command, stamp_ns = self._read(data), stamp_ns_of(data)
            if stamp_ns < expected_ns:
                return
            if stamp_ns > expected_ns:
                raise InputError(
                    f"muscle_command: expected the stamp of the observation it answers, "
                    f"{expected_ns} ns, got {stamp_ns} ns"
                )
            values = values_of(command, command.name, "muscle_command")
            targets = self._plant.targets(command.name, values)
        except InputError as error:
            self.diagnostics.refuse(str(error))
            return
        self._publish(self._plant.execute(targets))

    def _publish(self, observation: Observation) -> None:
        self._observation = observation
        self.diagnostics.count()
        self._repeat_timer.reset()
        self._send(observation)

    def _repeat(self) -> None:
        if self._observation is not None:
            self._send(self._observation)

    def _send(self, observation: Observation) -> None:
        self._publisher.publish(observation.number * self._period_ns, observation)

    def _state_of_run(self) -> dict[str, str]:
        if self._observation is None:
            return {"state": "waiting for an episode"}
        state = "in an episode" if self._plant.is_waiting else "between episodes"
        return {"state": state, "observation": str(self._observation.number)}

    def destroy_node(self) -> None:
        """Release the camera with the node."""
        self._plant.close()
        super().destroy_node()


def main() -> None:
    """Run the node until it is told to stop."""
    sys.exit(run_node(EyePlantNode))
