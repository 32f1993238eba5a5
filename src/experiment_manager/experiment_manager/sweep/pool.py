"""The cells of a sweep, so many at a time, on this machine."""

import signal
import subprocess
import sys
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed

from experiment_manager.sweep.cell_run import CellRun, is_failure
from lockstep.exit_codes import EXIT_FAULT, EXIT_INTERRUPTED
from lockstep.machine.interrupts import Interrupts


class Pool:
    """Makes runs, each in a process of its own; SIGINT stops them all, with checkpoints."""

    def __init__(self, jobs: int) -> None:
        """jobs: how many at a time."""
        self._jobs = jobs
        self._sent: dict[subprocess.Popen[bytes], int] = {}
        self._interrupts = Interrupts(self._pass_on)

    def run(self, runs: Sequence[CellRun]) -> int:
        """Make the runs that are not done; return 0, 3 when some failed, 130 when stopped."""
        failed: dict[CellRun, str] = {}
        with ThreadPoolExecutor(self._jobs) as threads:
            futures = {threads.submit(self._make, run): run for run in runs}
            for n_done, future in enumerate(as_completed(futures), 1):
                run = futures[future]
                try:
                    code = future.result()
                except OSError as error:  # its log cannot be written: the others go on
                    code, failed[run] = EXIT_FAULT, str(error)
                else:
                    interrupted = self._interrupts.count > 0
                    if code is not None and is_failure(code, interrupted=interrupted):
                        failed[run] = run.failure()
                if not self._interrupts.count or run.is_done:
                    print(f"{n_done}/{len(futures)} {run.cell.name}: {_said(run, code)}")
        for run, reason in failed.items():
            print(f"failed: {run.cell.name}: {reason}; log: {run.log}", file=sys.stderr)
        if self._interrupts.count:
            return EXIT_INTERRUPTED
        return EXIT_FAULT if failed else 0

    def _make(self, run: CellRun) -> int | None:
        if self._interrupts.count:
            return None
        return run.run(self._started)

    def _started(self, process: "subprocess.Popen[bytes]") -> None:
        self._sent[process] = 0
        self._pass_on()

    def _pass_on(self) -> None:
        """Interrupt each process as often as this one was."""
        for process, n_sent in list(self._sent.items()):
            if n_sent < self._interrupts.count:
                self._sent[process] = self._interrupts.count
                if process.poll() is None:
                    process.send_signal(signal.SIGINT)


def _said(run: CellRun, code: int | None) -> str:
    if run.is_done:
        return "done"
    if code is None:
        return "another process is making it"
    return f"ended with exit code {code}"
