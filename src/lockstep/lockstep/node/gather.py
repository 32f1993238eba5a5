"""Messages of several topics that belong to one observation, gathered by their stamp."""

from collections.abc import Sequence
from typing import Any

# Incomplete stamps held at once. The plant sends one at a time; more are somebody else's, and must
# neither fill the memory nor keep the plant's from being completed.
N_PENDING = 8


class Gather:
    """Holds back the messages of a stamp until one of each topic is there.

    Topics of one observation arrive in any order. A complete set discards the incomplete older
    ones (their publisher has gone on) and older stamps are ignored from then on; the same stamp
    may come again, which is how a waiting plant repeats itself.
    """

    def __init__(self, topics: Sequence[str]) -> None:
        """topics: the names under which messages are added."""
        self._n_topics = len(frozenset(topics))
        self._complete_ns = -1
        self._pending: dict[int, dict[str, Any]] = {}

    def holds(self, topic: str) -> bool:
        """Return whether a message of the topic waits for others of its stamp."""
        return any(topic in messages for messages in self._pending.values())

    def add(self, topic: str, stamp_ns: int, message: Any) -> dict[str, Any] | None:
        """Add a message; return {topic: message} when this one completes its stamp."""
        if stamp_ns < self._complete_ns:
            return None
        messages = self._pending.get(stamp_ns)
        if messages is None:
            if len(self._pending) >= N_PENDING:
                del self._pending[next(iter(self._pending))]
            messages = self._pending[stamp_ns] = {}
        messages[topic] = message
        if len(messages) < self._n_topics:
            return None
        self._complete_ns = stamp_ns
        self._pending = {ns: held for ns, held in self._pending.items() if ns > stamp_ns}
        return messages

    def reset(self) -> None:
        """Forget everything, so that stamps may start again from 0 (a new run)."""
        self._complete_ns = -1
        self._pending = {}
