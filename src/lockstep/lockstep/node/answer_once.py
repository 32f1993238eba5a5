"""The same observation gets the same answer, and is learned from once."""

import enum


class Verdict(enum.Enum):
    """What to do with an observation."""

    NEW = enum.auto()
    REPEATED = enum.auto()
    OLD = enum.auto()


class AnswerOnce:
    """Judges the stamps of observations.

    The answers themselves stay in the publishers (`VectorPublisher.repeat`), so that a repeated
    observation costs no memory.
    """

    def __init__(self) -> None:
        """Start with no observation answered."""
        self._answered_ns = -1

    def judge(self, stamp_ns: int) -> Verdict:
        """Return the verdict on the observation of that stamp."""
        if stamp_ns > self._answered_ns:
            return Verdict.NEW
        return Verdict.REPEATED if stamp_ns == self._answered_ns else Verdict.OLD

    def answered(self, stamp_ns: int) -> None:
        """Note that the observation of that stamp has been answered."""
        self._answered_ns = stamp_ns

    def reset(self) -> None:
        """Forget everything, so that stamps may start again from 0 (a new run)."""
        self._answered_ns = -1
