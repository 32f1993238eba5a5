"""The runs of a sweep, so many at a time, on this machine."""

import signal
import subprocess
import sys
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed

from experiment_manager.sweep.sweep_run import SweepRun
from lockstep.exit_codes import EXIT_FAULT, EXIT_INTERRUPTED
from lockstep.machine.interrupts import Interrupts


class Pool:
    """Makes runs, each in a process of its own; SIGINT stops them all, with checkpoints."""

    def __init__(self, jobs: int, start: Sequence[str]) -> None:
        """jobs: how many at a time; start: as of `SweepRun.make`."""
        self._jobs, self._start = jobs, start
        self._sent: dict[subprocess.Popen[bytes], int] = {}
        self._interrupts = Interrupts(self._pass_on)

    def run(self, runs: Sequence[SweepRun]) -> int:
        """Make the runs that are not done; return 0, 3 when some failed, 130 when stopped."""
        failed: dict[SweepRun, str] = {}
        with ThreadPoolExecutor(self._jobs) as threads:
            futures = {threads.submit(self._make, run): run for run in runs}
            for n_ended, future in enumerate(as_completed(futures), 1):
                run = futures[future]
                said, failure = future.result()
                if said:
                    print(f"{n_ended}/{len(futures)} {run.name}: {said}")
                if failure:
                    failed[run] = failure
        for run, failure in failed.items():
            print(f"failed: {run.name}: {failure}; log: {run.log}", file=sys.stderr)
        if self._interrupts.count:
            return EXIT_INTERRUPTED
        return EXIT_FAULT if failed else 0

    def _make(self, run: SweepRun) -> tuple[str, str]:
        """Make a run; return what to say of it, and why it failed, "" each for nothing."""
        if self._interrupts.count:
            return "", ""
        try:
            if not run.make(self._start, self._started):
                return "another process is making it", ""
        except OSError as error:  # its log cannot be written: the others go on
            return "failed", str(error)
        return run.state, run.failure()

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
