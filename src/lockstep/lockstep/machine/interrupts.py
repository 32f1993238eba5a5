"""The wish to stop a run, as signals bring it.

Ctrl-C: whoever makes a run counts here how often it was asked to stop. How a signal reaches a node
is in `lockstep.node.process`.
"""

import os
import signal
import sys
from collections.abc import Callable
from contextlib import suppress
from types import FrameType
from typing import Any


class Interrupts:
    """Counts SIGINT and SIGTERM from now on, and SIGHUP unless nohup has it ignored.

    The first one asks for a stop after the episode under way, the second for one at once.
    """

    def __init__(self, then: Callable[[], None] = lambda: None, *, listens: bool = True) -> None:
        """then: called at each, from a signal handler; listens: not in a thread of its own."""
        self.count = 0
        self._then = then
        self._before: dict[signal.Signals, Any] = {}
        if not listens:
            return
        self._listen(signal.SIGINT, self._interrupt)
        self._listen(signal.SIGTERM, self._interrupt)
        if signal.getsignal(signal.SIGHUP) != signal.SIG_IGN:
            self._listen(signal.SIGHUP, self._hang_up)

    def _listen(self, number: signal.Signals, handler: Any) -> None:
        self._before[number] = signal.signal(number, handler)

    def stop(self) -> None:
        """Give the signals back to whoever had them before."""
        while self._before:
            signal.signal(*self._before.popitem())

    def _interrupt(self, number: int, frame: FrameType | None) -> None:
        self.count += 1
        self._then()
        if self.count == 1:
            _say("\nstopping after this episode, with a checkpoint\n")

    def _hang_up(self, number: int, frame: FrameType | None) -> None:
        # A terminal that is closed says so more than once, a person who wants to stop at once not.
        if not self.count:
            self._interrupt(number, frame)


def _say(text: str) -> None:
    """Write to standard error, where it is open.

    A signal may come while the stream itself is being written, which takes no second text then.
    """
    with suppress(OSError, ValueError):
        if sys.stderr is not None:
            os.write(sys.stderr.fileno(), text.encode())
