"""One run of a sweep as a process: who makes it holds its log, and how it ended stands there.

The lock on the log is the kernel's: it is gone with the last process that has the file open.
"""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

from experiment_manager.measures.results import read_results
from experiment_manager.run.described_run import DescribedRun
from experiment_manager.run.run_directory import CONFIG_FILE, RESULTS_FILE
from experiment_manager.sweep.sweep_file import Cell
from lockstep import InputError
from lockstep.exit_codes import EXIT_BAD_INPUT, EXIT_FAULT, EXIT_INTERRUPTED
from lockstep.machine.locks import takes_lock

# Who only looks whether a log is held holds it for a moment.
_N_TRIES, _BETWEEN_TRIES_S = 5, 0.1
_ENDED = b"ended with exit code "
_ERROR = b"error: "
_LAST_BYTES = 1 << 14


class CellRun:
    """A cell of a sweep directory."""

    def __init__(self, directory: Path, cell: Cell) -> None:
        """directory: of the sweep."""
        self.cell = cell
        self.directory = directory / cell.name
        self.log = directory / "logs" / f"{cell.name}.log"

    @property
    def is_done(self) -> bool:
        """Whether the run has come to its end, also after it was made longer."""
        try:
            results = read_results(self.directory / RESULTS_FILE)
            text = (self.directory / CONFIG_FILE).read_text()
            run = DescribedRun(self.directory, text, CONFIG_FILE)
        except (InputError, OSError, UnicodeDecodeError):
            return False
        return results.iterations >= run.n_iterations

    @property
    def is_running(self) -> bool:
        """Whether some process, perhaps on another machine, is at it."""
        if not self.log.exists():
            return False
        with self.log.open("rb") as log:
            return not takes_lock(log, shared=True)

    def failure(self) -> str:
        """Return why it failed the last time, "" when it did not, or was only stopped."""
        lines = self._last_lines()
        if not lines or not lines[-1].startswith(_ENDED):
            return ""
        code = int(lines[-1].removeprefix(_ENDED))
        if code in (0, EXIT_INTERRUPTED, -signal.SIGINT):  # the last: before it could listen
            return ""
        errors = [line for line in lines if _ERROR in line]
        reason = errors[-1].rpartition(_ERROR)[2] if errors else lines[-1]
        return reason.decode(errors="replace")

    def _last_lines(self) -> list[bytes]:
        if not self.log.exists():
            return []
        with self.log.open("rb") as log:
            log.seek(max(0, log.seek(0, os.SEEK_END) - _LAST_BYTES))
            return [line for line in log.read().replace(b"\r", b"\n").split(b"\n") if line]

    def run(self, on_start: Callable[["subprocess.Popen[bytes]"], None]) -> int | None:
        """Begin the run or go on with it; return its exit code, None when somebody is at it.

        on_start: called with the process, which may be sent SIGINT to stop it with a checkpoint.
        Raises OSError when the log cannot be written.
        """
        self.log.parent.mkdir(parents=True, exist_ok=True)
        with self.log.open("ab") as log:
            for _ in range(_N_TRIES):
                if takes_lock(log):
                    break
                time.sleep(_BETWEEN_TRIES_S)
            else:
                return None
            process = subprocess.Popen(
                self._command(),
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                start_new_session=True,  # Ctrl-C in the terminal is for the sweep alone
            )
            on_start(process)
            code = process.wait()
            log.write(b"\n%s%d\n" % (_ENDED, code))
            return code

    def _command(self) -> list[str]:
        if not (self.directory / CONFIG_FILE).exists():
            # A kill may have left the directory, and a configuration half-written, but no more.
            (self.directory / f"{CONFIG_FILE}.part").unlink(missing_ok=True)
        module = "active_binocular_vision.commands.sweep_cell"
        words = (str(os.getpid()), str(self.directory), self.cell.request.to_json())
        return [sys.executable, "-m", module, *words]


def is_failure(code: int, *, interrupted: bool) -> bool:
    """Return whether an exit code means that a run failed.

    interrupted: somebody asked it to stop, perhaps before it could listen: then only what it says
    itself is a failure.
    """
    if interrupted:
        return code in (EXIT_BAD_INPUT, EXIT_FAULT)
    return code not in (0, EXIT_INTERRUPTED)
