"""The wish to stop a run, said while standard error is busy."""

import os
import signal
import sys
from collections.abc import Iterator

import pytest

from lockstep.machine.interrupts import Interrupts

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


@pytest.fixture(autouse=True)
def _as_before() -> Iterator[None]:
    before = {number: signal.getsignal(number) for number in SIGNALS}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


class _Busy:
    """A stream in the middle of a write, as a signal finds it."""

    def __init__(self, number: int) -> None:
        self._number = number

    def fileno(self) -> int:
        return self._number

    def write(self, text: str) -> int:
        raise RuntimeError("reentrant call inside <_io.BufferedWriter name='<stderr>'>")


def test_a_signal_that_meets_a_write_is_counted_and_said(monkeypatch) -> None:
    read, write = os.pipe()
    monkeypatch.setattr(sys, "stderr", _Busy(write))
    interrupts = Interrupts()
    signal.raise_signal(signal.SIGINT)
    signal.raise_signal(signal.SIGINT)
    os.close(write)
    assert interrupts.count == 2
    assert os.read(read, 1000) == b"\nstopping after this episode, with a checkpoint\n"
    os.close(read)


@pytest.mark.parametrize("is_closed", [True, False])
def test_a_signal_without_a_standard_error_is_counted(monkeypatch, is_closed: bool) -> None:
    read, write = os.pipe()
    os.close(read)  # nobody reads any more
    monkeypatch.setattr(sys, "stderr", None if is_closed else _Busy(write))
    interrupts = Interrupts()
    signal.raise_signal(signal.SIGTERM)
    assert interrupts.count == 1
    os.close(write)
