"""Standard output that may go away: a run outlives the terminal or the pipe that it speaks to."""

import os
import sys
from typing import Any, TextIO, cast


class _Lasting:
    """A text stream whose text goes nowhere from the moment when it cannot be written."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        try:
            return self._stream.write(text)
        except OSError:
            self._let_go()
            return len(text)

    def flush(self) -> None:
        try:
            self._stream.flush()
        except OSError:
            self._let_go()

    def _let_go(self) -> None:
        # Under the same number, since the stream may still hold what could not be written.
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, self._stream.fileno())
        os.close(nowhere)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


def lasting(stream: TextIO) -> TextIO:
    """Return the stream in a shape that goes on when nobody takes its text any more."""
    return cast(TextIO, _Lasting(stream))


def ignore_broken_pipes() -> None:
    """Let this process outlive whoever reads its standard streams; closed ones go nowhere.

    A reader such as `head` may leave early.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest number that is free: this one
    # Python has None for those that it found closed.
    out: TextIO | None = sys.stdout
    error: TextIO | None = sys.stderr
    sys.stdout = lasting(out or os.fdopen(1, "w", closefd=False))
    sys.stderr = lasting(error or os.fdopen(2, "w", closefd=False))
