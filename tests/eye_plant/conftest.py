"""What the tests of the plant share."""

import signal
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.eye_plant.plant_bench import plant_bench
from tests.node_harness import Bench, Graph


@pytest.fixture
def bench(graph: Graph, pictures: Path) -> Bench:
    """Return a plant with small stimuli whose run has started."""
    bench = plant_bench(graph, pictures)
    assert bench.request("start_run") == (True, "")
    return bench


@pytest.fixture
def ctrl_c_amid_locks(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Interrupt this thread once, just after a condition lets go of its lock.

    CPython makes a RuntimeError of a KeyboardInterrupt there. Python's own handler is set before:
    where tests run as a shell's background job, SIGINT is ignored.
    """

    def release_and_interrupt(condition: Any) -> None:
        condition._lock.release()
        if threading.current_thread() is threading.main_thread():
            monkeypatch.undo()
            signal.raise_signal(signal.SIGINT)

    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    monkeypatch.setattr(threading.Condition, "_release_save", release_and_interrupt)
    yield
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    signal.signal(signal.SIGINT, before)
