"""What C libraries write on standard error, some of which say in no other way what is wrong."""

import os
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager

_STANDARD_ERROR = 2
# The number is the process': one at a time may have it.
_LOCK = threading.Lock()


@contextmanager
def library_messages() -> Iterator[Callable[[], str]]:
    """Keep what the block writes to standard error from it; yield a function that returns that.

    Behind the block, where the system allows it; "" otherwise.
    """
    text = ""

    def messages() -> str:
        return text

    with _LOCK, ExitStack() as stack:
        try:
            before = os.dup(_STANDARD_ERROR)
            stack.callback(os.close, before)
            heard = stack.enter_context(os.fdopen(os.memfd_create("messages"), "w+b"))
        except OSError:  # it is closed, or a sandbox has no files in memory
            yield messages
            return
        os.dup2(heard.fileno(), _STANDARD_ERROR)
        try:
            yield messages
        finally:
            os.dup2(before, _STANDARD_ERROR)
            heard.seek(0)
            text = heard.read().decode(errors="replace")
