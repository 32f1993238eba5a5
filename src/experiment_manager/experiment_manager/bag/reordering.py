"""Holds messages back for a moment, so that a bag has them in the order of their stamps."""

from collections.abc import Iterable
from typing import NamedTuple


class Held(NamedTuple):
    """A message that waits; sorted by stamp, then by the topic's number, then by arrival."""

    stamp_ns: int
    i_topic: int
    i_arrival: int
    arrived_s: float
    topic: str
    message: bytes


class StampBuffer:
    """Messages that may still be followed by older ones.

    Topics arrive each at their own pace: what was sent together comes bunch by bunch.
    """

    def __init__(self, topics: Iterable[str]) -> None:
        """topics: in the order that their messages of one stamp will have."""
        self._i_topic = {topic: i for i, topic in enumerate(topics)}
        self._held: list[Held] = []
        self._n_arrived = 0

    def add(self, topic: str, message: bytes, stamp_ns: int, now_s: float) -> None:
        """Hold a message back."""
        self._n_arrived += 1
        self._held.append(
            Held(stamp_ns, self._i_topic[topic], self._n_arrived, now_s, topic, message)
        )

    def put_back(self, held: Iterable[Held]) -> None:
        """Hold messages back again that were taken."""
        self._held.extend(held)

    def take_all(self) -> list[Held]:
        """Return all messages in order, and hold none of them."""
        taken, self._held = sorted(self._held), []
        return taken

    def take_before(self, stamp_ns: int) -> list[Held]:
        """Return those with a smaller stamp in order, and hold them no longer."""
        taken = sorted(held for held in self._held if held.stamp_ns < stamp_ns)
        if taken:
            self._held = [held for held in self._held if held.stamp_ns >= stamp_ns]
        return taken

    def take_arrived_by(self, arrived_s: float) -> list[Held]:
        """Return those that arrived by then, and those with no greater stamp, in order."""
        stamps_ns = [held.stamp_ns for held in self._held if held.arrived_s <= arrived_s]
        return self.take_before(max(stamps_ns) + 1) if stamps_ns else []
