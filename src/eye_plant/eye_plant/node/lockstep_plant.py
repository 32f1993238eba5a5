"""A plant in lockstep: it publishes an observation, waits for the answer, executes it."""

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any, Generic, Protocol, TypeVar

import numpy as np
from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from sensor_msgs.msg import JointState

from eye_plant.episode import Episode
from eye_plant.observation import Seen
from lockstep import InputError
from lockstep.node.diagnostics import Diagnostics
from lockstep.node.requests import END_RUN, START_RUN, Arguments, Handler, RequestServer
from lockstep.wire.cdr import stamp_ns_of
from lockstep.wire.codec import Reader
from lockstep.wire.qos import LOCKSTEP_QOS
from lockstep.wire.vectors import values_of

REPEAT_PERIOD_S = 1.0
# Requests are asked of it, whatever the node's own name.
NAME = "eye_plant"

Observed = TypeVar("Observed", bound=Seen)
Made_co = TypeVar("Made_co", bound=Seen, covariant=True)


class Plant(Protocol[Made_co]):
    """What makes observations: the eyes, or a robot's head."""

    @property
    def is_waiting(self) -> bool:
        """Whether an episode is under way."""

    def begin(self, episode: Episode) -> Made_co:
        """Start an episode."""

    def targets(self, names: Sequence[str], values: np.ndarray) -> np.ndarray:
        """Return what a command asks for."""

    def execute(self, targets: np.ndarray) -> Made_co:
        """Execute a command."""

    def close(self) -> None:
        """Release what it holds."""


P = TypeVar("P", bound=Plant[Any])


class LockstepPlant(Node, Generic[P, Observed]):
    """Answers requests for episodes, and repeats itself while it waits.

    A subclass makes `plant` and `diagnostics`, and then calls `_wait_for_episodes`.
    """

    plant: P
    diagnostics: Diagnostics

    def __init__(self, name: str, **kwargs: Any) -> None:
        """Wait for nothing yet."""
        super().__init__(name, **kwargs)
        self._observation: Observed | None = None
        self._stamp_ns = -1

    @abstractmethod
    def check_episode(self, last_observation: int) -> None:
        """Raise InputError for an episode that cannot be made; last_observation: its number."""

    @abstractmethod
    def stamp_ns(self, observation: Observed) -> int:
        """Return the stamp of a new observation; stamps grow during a run."""

    @abstractmethod
    def send(self, stamp_ns: int, observation: Observed) -> None:
        """Publish an observation, for the first time or again."""

    def _wait_for_episodes(self, topic: str, handlers: Mapping[str, Handler]) -> None:
        """topic: of commands; handlers: of requests beyond those of each plant."""
        self._topic, self._read = topic, Reader(JointState, topic)
        self.create_subscription(JointState, topic, self._command, LOCKSTEP_QOS, raw=True)
        of_each = {START_RUN: self._end_run, "episode": self._begin, END_RUN: self._end_run}
        self._requests = RequestServer(self, self.diagnostics, {**of_each, **handlers}, NAME)
        self._repeat_timer = self.create_timer(
            REPEAT_PERIOD_S, self._repeat, clock=Clock(clock_type=ClockType.STEADY_TIME)
        )

    def _end_run(self, _: Arguments) -> None:
        self._observation = None

    def _begin(self, arguments: Arguments) -> None:
        episode = Episode.from_arguments(arguments)
        self.check_episode(episode.first_observation + episode.n_iterations)
        self._publish(self.plant.begin(episode))

    def _command(self, data: bytes) -> None:
        if self._observation is None or not self.plant.is_waiting:
            # The repeated answer to an observation that is over is no fault.
            return
        try:
            command, stamp_ns = self._read(data), stamp_ns_of(data)
            if stamp_ns < self._stamp_ns:
                return
            if stamp_ns > self._stamp_ns:
                raise InputError(
                    f"{self._topic}: expected the stamp of the observation it answers, "
                    f"{self._stamp_ns} ns, got {stamp_ns} ns"
                )
            values = values_of(command, command.name, self._topic)
            targets = self.plant.targets(command.name, values)
        except InputError as error:
            self.diagnostics.refuse(str(error))
            return
        self._publish(self.plant.execute(targets))

    def _publish(self, observation: Observed) -> None:
        self._observation, self._stamp_ns = observation, self.stamp_ns(observation)
        self.diagnostics.count()
        self._repeat_timer.reset()
        self.send(self._stamp_ns, observation)

    def _repeat(self) -> None:
        if self._observation is not None:
            self.send(self._stamp_ns, self._observation)

    def _state_of_run(self) -> dict[str, str]:
        if self._observation is None:
            return {"state": "waiting for an episode"}
        state = "in an episode" if self.plant.is_waiting else "between episodes"
        return {"state": state, "observation": str(self._observation.number)}

    def destroy_node(self) -> None:
        """Release the plant with the node."""
        self.plant.close()
        super().destroy_node()
