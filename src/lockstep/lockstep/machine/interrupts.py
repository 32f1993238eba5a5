"""The wish to stop a run, as signals bring it."""

import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
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
            print("\nstopping after this episode, with a checkpoint", file=sys.stderr)

    def _hang_up(self, number: int, frame: FrameType | None) -> None:
        # A terminal that is closed says so more than once, a person who wants to stop at once not.
        if not self.count:
            self._interrupt(number, frame)


@contextmanager
def interrupted_between_steps() -> Iterator[Callable[[], None]]:
    """Keep Ctrl-C from raising inside; yield what raises KeyboardInterrupt if it has come.

    For work of a pool of threads: raised in the midst of a pool's locks, a KeyboardInterrupt may
    come out as a RuntimeError. It is raised at the end where no step has raised it. A thread other
    than the main one, or with another handler than Python's, is never interrupted by an exception,
    and nothing changes for it.
    """
    came = False

    def note(number: int, frame: FrameType | None) -> None:
        nonlocal came
        came = True

    def check() -> None:
        if came:
            raise KeyboardInterrupt

    before = signal.getsignal(signal.SIGINT)
    is_ours = (
        threading.current_thread() is threading.main_thread()
        and before is signal.default_int_handler
    )
    if is_ours:
        signal.signal(signal.SIGINT, note)
    try:
        yield check
    finally:
        if is_ours:
            signal.signal(signal.SIGINT, before)
    check()
