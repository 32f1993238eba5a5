"""Which node of a run has gone silent, from what they say on /diagnostics each second."""

import os
import select
import time
from collections.abc import Sequence
from contextlib import AbstractContextManager

from experiment_manager.supervision.fork_server import ForkServer, stop
from experiment_manager.supervision.processes import PACKAGES
from lockstep.machine.unfinished_ports import unfinished_ports

# To make a node may hang for ever, deaf to signals: a process that supervises has none itself.
LISTENER = "experiment_manager.supervision.listener"
LISTENER_NODE = "supervisor"
START_LIMIT_S = 120.0
SILENCE_LIMIT_S = 10.0
_MOST_BYTES = 1 << 16


class Heartbeats(AbstractContextManager["Heartbeats"]):
    """Has a process listen in one domain while the block lasts.

    heard: the names of all who have said something.
    """

    def __init__(
        self, fork_server: ForkServer, domain: int, packages: Sequence[str] = PACKAGES
    ) -> None:
        """Begin to listen to these nodes; each has START_LIMIT_S to say something.

        Raises ConnectionError when the fork server has ended.
        """
        self._output, theirs = os.pipe()
        os.set_blocking(self._output, False)
        with os.fdopen(theirs, "wb") as log:
            self._process = fork_server.start(LISTENER, [], domain, log)
        self._rest = ""
        self._last_words = "without a word"
        self.heard: set[str] = set()
        self._deadline_s = dict.fromkeys(
            (LISTENER_NODE, *packages), time.monotonic() + START_LIMIT_S
        )

    def __exit__(self, *exception: object) -> None:
        """Leave the domain."""
        stop([self._process])
        os.close(self._output)

    def wait(self, timeout_s: float = 0.2) -> str | None:
        """Listen for a moment; return the fault of a node that has been silent for too long."""
        select.select([self._output], [], [], timeout_s)
        has_ended = self._process.exit_code() is not None  # before the last that it has said
        for line in self._lines():
            self._hear(line)
        if has_ended:
            return f"the supervisor's own node ended: {self._last_words}"
        now_s = time.monotonic()
        silent = [name for name, end_s in self._deadline_s.items() if now_s > end_s]
        if not silent:
            return None
        return f"{silent[0]} does not respond{unfinished_text()}"

    def _hear(self, line: str) -> None:
        if not line.strip():
            return
        self._last_words = line
        self.heard.add(line)
        if line in self._deadline_s:
            self._deadline_s[line] = time.monotonic() + SILENCE_LIMIT_S

    def _lines(self) -> list[str]:
        """Return what the listener has said in whole lines since the last look."""
        try:
            self._rest += os.read(self._output, _MOST_BYTES).decode(errors="replace")
        except BlockingIOError:
            return []
        *lines, self._rest = self._rest.split("\n")
        return lines


def unfinished_text() -> str:
    """Return which shared memory may be what a node hangs in, "" when there is none such."""
    return "".join(f"; {path} was left unfinished" for path in unfinished_ports())
