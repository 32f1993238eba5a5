"""One run of a sweep as a process: who makes it holds its log, and how it ended stands there.

The lock on the log is the kernel's: it is gone with the last process that has the file open.
"""

import os
import signal
import subprocess
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from experiment_manager.measures.results import RESULTS_FILE, read_results
from experiment_manager.run.config_file import CONFIG_FILE, about_in
from lockstep import InputError
from lockstep.exit_codes import EXIT_INTERRUPTED
from lockstep.files.locks import takes_lock

# Who only looks whether a log is held holds it for a moment.
_N_TRIES, _BETWEEN_TRIES_S = 5, 0.1
_ENDED = "ended with exit code "
_ERROR = "error: "


class SweepRun:
    """A run in the directory of a sweep."""

    def __init__(self, directory: Path, name: str) -> None:
        """directory: of the sweep."""
        self.name = name
        self.directory = directory / name
        self.log = directory / "logs" / f"{name}.log"

    @property
    def is_done(self) -> bool:
        """Whether the run has come to its end, also after it was made longer."""
        try:
            results = read_results(self.directory / RESULTS_FILE)
            about = about_in((self.directory / CONFIG_FILE).read_text())
        except (InputError, OSError, UnicodeDecodeError):
            return False
        return results.iterations >= int(about["n_training_iterations"])

    @property
    def state(self) -> str:
        """Where it stands: done, running, failed, stopped or waiting.

        It is running when some process, perhaps on another machine, holds its log.
        """
        if self.is_done:
            return "done"
        if self.log.exists():
            with self.log.open("rb") as log:
                if not takes_lock(log, shared=True):
                    return "running"
        if self.failure():
            return "failed"
        return "stopped" if self.directory.exists() else "waiting"

    @property
    def exit_code(self) -> int | None:
        """Exit code of the process that made it last, None while or when none has ended."""
        *_, last = self._lines()
        return int(last.removeprefix(_ENDED)) if last.startswith(_ENDED) else None

    def failure(self) -> str:
        """Return why it failed the last time, "" when it did not, or was only stopped."""
        if self.exit_code in (None, 0, EXIT_INTERRUPTED, -signal.SIGINT):
            return ""  # the last: before it could listen
        reasons = [line.rpartition(_ERROR)[2] for line in self._lines() if _ERROR in line]
        return reasons[-1] if reasons else f"{_ENDED}{self.exit_code}"

    def _lines(self) -> list[str]:
        """Return the lines of its log, the first empty."""
        text = self.log.read_text(errors="replace") if self.log.exists() else ""
        return ["", *(line for line in text.splitlines() if line)]

    def make(
        self, start: Sequence[str], on_start: Callable[["subprocess.Popen[bytes]"], None]
    ) -> bool:
        """Begin the run or go on with it; return False when somebody else is at it.

        start: command line of a run without its last two arguments: the number of this process,
        with which the run dies, and the run's directory; on_start: called with the process, which
        may be sent SIGINT to stop it with a checkpoint. Raises OSError when the log cannot be
        written.
        """
        self.log.parent.mkdir(parents=True, exist_ok=True)
        with self.log.open("ab") as log:
            for _ in range(_N_TRIES):
                if takes_lock(log):
                    break
                time.sleep(_BETWEEN_TRIES_S)
            else:
                return False
            process = subprocess.Popen(
                [*start, str(os.getpid()), str(self.directory)],
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                start_new_session=True,  # Ctrl-C in the terminal is for the sweep alone
            )
            on_start(process)
            code = process.wait()
            log.write(f"\n{_ENDED}{code}\n".encode())
        return True
