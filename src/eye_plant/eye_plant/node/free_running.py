"""The plant as an instrument: commands act on arrival, observations come at a fixed rate."""

import numpy as np
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from sensor_msgs.msg import JointState

from eye_plant.commands import target_activations
from eye_plant.config import EyePlantConfig
from eye_plant.episode import Episode
from eye_plant.node.publisher import ObservationPublisher
from eye_plant.plant import EyePlant
from lockstep import InputError
from lockstep.node.diagnostics import Diagnostics
from lockstep.node.requests import END_RUN, START_RUN, Arguments, RequestServer
from lockstep.wire.qos import LOCKSTEP_QOS
from lockstep.wire.stamps import MAX_STAMP_NS, check_stamp, period_ns
from lockstep.wire.vectors import values_of


class FreeRunning:
    """Simulates on and on, for saccades and for users without an experiment manager.

    One period of simulated time passes per period of steady time, or less when the machine is too
    slow. A command counts from its arrival, whatever its stamp. An episode can be requested to show
    something else; at its end the last observation is repeated.
    """

    def __init__(
        self,
        node: Node,
        config: EyePlantConfig,
        plant: EyePlant,
        publisher: ObservationPublisher,
        diagnostics: Diagnostics,
    ) -> None:
        """Begin with all muscles at tonic level before the configured stimulus."""
        free = config.free_running
        self._plant = plant
        self._publisher = publisher
        self._diagnostics = diagnostics
        self._period_s = 1.0 / free.rate_hz
        self._period_ns = period_ns(self._period_s)
        self._targets: np.ndarray = plant.oculomotor.tonic_activations
        endless = MAX_STAMP_NS // self._period_ns
        self._observation = plant.begin(
            Episode.alone(free.stimulus, free.object_distance_m, self._targets.tolist(), endless)
        )
        node.create_subscription(JointState, "muscle_command", self._command, LOCKSTEP_QOS)
        self._requests = RequestServer(
            node,
            diagnostics,
            # A run changes nothing.
            {START_RUN: lambda _: None, "episode": self._begin, END_RUN: lambda _: None},
        )
        node.create_timer(
            self._period_s, self._advance, clock=Clock(clock_type=ClockType.STEADY_TIME)
        )

    def _begin(self, arguments: Arguments) -> None:
        episode = Episode.from_arguments(arguments)
        check_stamp(episode.first_observation + episode.n_iterations, self._period_ns)
        self._observation = self._plant.begin(episode)
        self._targets = np.array(episode.activations)

    def _command(self, message: JointState) -> None:
        try:
            values = values_of(message, message.name, "muscle_command")
            # Of two commands within a period, the second keeps the targets of the first.
            self._targets = target_activations(message.name, values, self._targets)
        except InputError as error:
            self._diagnostics.refuse(str(error))

    def _advance(self) -> None:
        self._publisher.publish(self._observation.number * self._period_ns, self._observation)
        self._diagnostics.count()
        if self._plant.is_waiting:
            self._observation = self._plant.advance(self._targets, self._period_s)
