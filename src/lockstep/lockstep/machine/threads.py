"""Work for all cores within this process, which Ctrl-C may end."""

import os
import signal
import threading
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from types import FrameType
from typing import TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")


def map_in_threads(function: Callable[[Item], Result], items: Iterable[Item]) -> list[Result]:
    """Return function of each item, in order, from as many threads as there are cores.

    Ctrl-C waits for the items under way, not for all: a KeyboardInterrupt that Python's own handler
    raised in the midst of the pool's locks might come out as a RuntimeError. A thread other than
    the main one, or with another handler, is never interrupted by an exception, and nothing changes
    for it.
    """
    came = False

    def note(number: int, frame: FrameType | None) -> None:
        nonlocal came
        came = True

    def check() -> None:
        if came:
            raise KeyboardInterrupt

    def work(item: Item) -> Result:
        check()
        return function(item)

    before = signal.getsignal(signal.SIGINT)
    is_ours = (
        threading.current_thread() is threading.main_thread()
        and before is signal.default_int_handler
    )
    if is_ours:
        signal.signal(signal.SIGINT, note)
    try:
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            results = list(pool.map(work, items))
    finally:
        if is_ours:
            signal.signal(signal.SIGINT, before)
    check()  # it came after the last item began
    return results
