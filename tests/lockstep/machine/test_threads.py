"""A function of many items on all cores, and Ctrl-C meanwhile."""

import signal
from collections.abc import Iterator
from types import FrameType

import pytest

from lockstep.machine.threads import map_in_threads


@pytest.fixture(autouse=True)
def pythons_handler() -> Iterator[None]:
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def interrupt(item: int) -> int:
    signal.raise_signal(signal.SIGINT)
    return item


def test_results_come_in_order() -> None:
    assert map_in_threads(lambda item: item**2, range(100)) == [item**2 for item in range(100)]


def test_ctrl_c_during_the_only_item_is_raised_after_it() -> None:
    with pytest.raises(KeyboardInterrupt):
        map_in_threads(interrupt, [0])
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_an_error_is_raised_and_pythons_handler_is_back() -> None:
    with pytest.raises(ZeroDivisionError):
        map_in_threads(lambda item: 1 / item, [1, 0])
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_another_handler_hears_ctrl_c_itself() -> None:
    heard = []

    def note(number: int, frame: FrameType | None) -> None:
        heard.append(number)

    signal.signal(signal.SIGINT, note)
    assert map_in_threads(interrupt, range(3)) == [0, 1, 2]
    assert heard
