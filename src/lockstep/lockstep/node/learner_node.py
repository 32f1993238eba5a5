"""What both learners have in common: gathering, answering once, and the requests of a run."""

from abc import abstractmethod
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

import numpy as np
from rclpy.node import Node
from rclpy.subscription import Subscription

from lockstep.errors import InputError
from lockstep.files.state_file import read_state, write_state
from lockstep.node.diagnostics import Diagnostics
from lockstep.node.gather import Gather
from lockstep.node.requests import END_RUN, START_RUN, Arguments, RequestServer
from lockstep.node.ros_parameters import declare_config
from lockstep.wire.cdr import stamp_ns_of
from lockstep.wire.codec import Reader
from lockstep.wire.qos import LOCKSTEP_QOS


class Learner(Protocol):
    """A learner whose whole state can be saved and restored."""

    @property
    def learning_steps(self) -> int:
        """How many steps it has learned."""

    def state(self) -> dict[str, np.ndarray]:
        """Return copies of everything that was learned."""

    def restore(self, state: Mapping[str, np.ndarray]) -> None:
        """Take over a state; raise ValueError, having changed nothing, when it does not fit."""


L = TypeVar("L", bound=Learner)


class LearnerNode(Node, Generic[L]):
    """A node that answers each observation once, and whose learner a run can save and load.

    A subclass says what an observation is made of, makes its learner, answers an observation
    (raising InputError to refuse it), and repeats its last answer.
    """

    def __init__(self, name: str, config_class: type, **kwargs: Any) -> None:
        """Set up the learner; raises InputError for a bad configuration."""
        super().__init__(name, **kwargs)
        self.config: Any = declare_config(self, config_class)
        inputs = self.inputs()
        self.learner = self.make_learner()
        self.diagnostics = Diagnostics(self, self._state_of_learning)
        self._gather = Gather(tuple(inputs))
        self._answered_ns = -1
        self._inputs = [
            self.create_subscription(
                kind,
                topic,
                partial(self._receive, topic, Reader(kind, topic)),
                LOCKSTEP_QOS,
                raw=True,
            )
            for topic, kind in inputs.items()
        ]
        self._last_topic = tuple(inputs)[-1]
        self._requests = RequestServer(
            self,
            self.diagnostics,
            {
                START_RUN: self._start_run,
                "save": self._save,
                "load": self._load,
                END_RUN: lambda _: self._forget_observations(),
            },
        )
        self.get_logger().info("ready, untrained")

    @abstractmethod
    def inputs(self) -> Mapping[str, type]:
        """Return the message type of each topic that makes up an observation, the last one last.

        Which one is published last makes no difference to what is answered, only to its cost.
        """

    @abstractmethod
    def make_learner(self) -> L:
        """Return an untrained learner of `self.config`."""

    @abstractmethod
    def answer(self, stamp_ns: int, observation: Mapping[str, Any]) -> None:
        """Publish the answer to an observation {topic: message}, and learn from it."""

    @abstractmethod
    def repeat(self) -> None:
        """Publish the last answer again."""

    def awaited_subscriptions(self) -> list[Subscription]:
        """Return the last input alone, unless it is there and others are late.

        To wake up for each of them would take this core from whoever is about to send the rest.
        """
        return self._inputs if self._gather.holds(self._last_topic) else self._inputs[-1:]

    def _receive(self, topic: str, read: Reader, data: bytes) -> None:
        try:
            message, stamp_ns = read(data), stamp_ns_of(data)
            observation = self._gather.add(topic, stamp_ns, message)
            if observation is not None:
                self._observe(stamp_ns, observation)
        except InputError as error:
            self.diagnostics.refuse(str(error))

    def _observe(self, stamp_ns: int, observation: Mapping[str, Any]) -> None:
        if stamp_ns == self._answered_ns:
            # The same observation gets the same answer, and is learned from once.
            self.repeat()
            return
        self.answer(stamp_ns, observation)
        self._answered_ns = stamp_ns
        self.diagnostics.count()

    def _start_run(self, _: Arguments) -> None:
        self._forget_observations()
        self.learner = self.make_learner()

    def _forget_observations(self) -> None:
        self._gather.reset()
        self._answered_ns = -1

    def _save(self, arguments: Arguments) -> None:
        path = _path_of(arguments)
        try:
            write_state(path, self.get_name(), self.learner.state())
        except OSError as error:
            raise InputError(f"state file {path}: cannot be written: {error}") from error

    def _load(self, arguments: Arguments) -> None:
        path = _path_of(arguments)
        state = read_state(path, self.get_name())
        try:
            self.learner.restore(state)
        except ValueError as error:
            raise InputError(f"state file {path}: {error}") from error
        self.get_logger().info(f"loaded {self.learner.learning_steps} learning steps from {path}")

    def _state_of_learning(self) -> dict[str, str]:
        return {"learning_steps": str(self.learner.learning_steps)}


def _path_of(arguments: Arguments) -> Path:
    path = arguments.get("path")
    if set(arguments) != {"path"} or not isinstance(path, str) or not Path(path).name:
        raise InputError(f"expected the path of a state file, got {arguments}")
    return Path(path)
