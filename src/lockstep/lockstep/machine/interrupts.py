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


class Interrupts:
    """Counts SIGINT and SIGTERM from now on, and SIGHUP unless nohup has it ignored.

    The first one asks for a stop after the episode under way, the second for one at once.
    """

    def __init__(self, then: Callable[[], None] = lambda: None) -> None:
        """then: called at each, from a signal handler."""
        self.count = 0
        self._then = then
        signal.signal(signal.SIGINT, self._interrupt)
        signal.signal(signal.SIGTERM, self._interrupt)
        if signal.getsignal(signal.SIGHUP) != signal.SIG_IGN:
            signal.signal(signal.SIGHUP, self._hang_up)

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
