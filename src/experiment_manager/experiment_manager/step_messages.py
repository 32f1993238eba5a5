"""The messages that a graph would have sent of a step of the loop, by the same functions."""

from collections.abc import Iterator
from typing import Any

from experiment_manager.loop import Step
from eye_plant import EyePlantConfig, Head
from eye_plant.head.messages import HeadMessages
from eye_plant.messages import ObservationMessages
from lockstep.wire.images import ImageBytes
from lockstep.wire.topics import (
    GAZE,
    GAZE_NAMES,
    actor_critic_names,
    command_topic,
    reward_names,
)
from lockstep.wire.vectors import VectorBytes
from sparse_coder.messages import features_message
from vergence_rl.messages import actor_critic_values

_WORD_BYTES = 4


class StepMessages:
    """Serializes steps: (topic, message) by (topic, message)."""

    def __init__(self, plant: EyePlantConfig, head: Head | None = None) -> None:
        """Lay out the messages; head: instead of the eyes."""
        self._space = plant.space
        self._observation: Any = (
            ObservationMessages(plant) if head is None else HeadMessages(head, self._space)
        )
        self._reward = VectorBytes(reward_names(plant.scales.names))
        self._gaze = VectorBytes(GAZE_NAMES)
        self._command = VectorBytes(self._space.names)
        self._actor_critic = VectorBytes(actor_critic_names(self._space))
        self._features = ImageBytes(features_message(len(plant.scales.all), plant.n_bases))

    def small(self, stamp_ns: int, step: Step) -> Iterator[tuple[str, bytes]]:
        """Yield what is recorded of each step."""
        yield from self._observation.vectors(stamp_ns, step.observation)
        answer = step.answer
        if answer is None:
            return
        yield "reward", self._reward.of(stamp_ns, answer.percept.reward_values())
        if answer.percept.gaze is not None:
            yield GAZE, self._gaze.of(stamp_ns, answer.percept.gaze.values())
        yield command_topic(self._space), self._command.of(stamp_ns, answer.decision.command)
        values = actor_critic_values(answer.decision, answer.agent_learning_steps)
        yield "actor_critic", self._actor_critic.of(stamp_ns, values)

    def large(self, stamp_ns: int, step: Step) -> Iterator[tuple[str, bytes]]:
        """Yield what is recorded of a sample of the episodes."""
        observation, answer = step.observation, step.answer
        if answer is None:
            return
        messages = self._observation
        for topic, message in messages.pictures(stamp_ns, observation):
            yield topic, _as_received(message)
        for topic, message in messages.camera_infos(stamp_ns, observation):
            yield topic, _as_received(message)
        yield "features", self._features.of(stamp_ns, answer.percept.encoding.features)


def _as_received(message: bytes) -> bytes:
    """Return the message with the zeros that RTPS fills up its last word with."""
    return message + bytes(-len(message) % _WORD_BYTES)
