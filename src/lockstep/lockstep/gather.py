"""Messages of several topics that belong to one observation, gathered by their stamp."""

from collections.abc import Sequence
from typing import Any


class Gather:
    """Holds back the messages of the newest stamp until one of each topic is there.

    Topics of one observation arrive in any order. A newer stamp discards an incomplete older one
    (its publisher has gone on), an older stamp is ignored; after a complete set the same stamp may
    come again, which is how a waiting plant repeats itself.
    """

    def __init__(self, topics: Sequence[str]) -> None:
        """topics: the names under which messages are added."""
        self._topics = frozenset(topics)
        self._stamp_ns = -1
        self._messages: dict[str, Any] = {}

    def add(self, topic: str, stamp_ns: int, message: Any) -> dict[str, Any] | None:
        """Add a message; return {topic: message} when this one completes its stamp."""
        if stamp_ns < self._stamp_ns:
            return None
        if stamp_ns > self._stamp_ns:
            self._stamp_ns = stamp_ns
            self._messages = {}
        self._messages[topic] = message
        if len(self._messages) < len(self._topics):
            return None
        complete, self._messages = self._messages, {}
        return complete

    def reset(self) -> None:
        """Forget everything, so that stamps may start again from 0 (a new run)."""
        self._stamp_ns = -1
        self._messages = {}
