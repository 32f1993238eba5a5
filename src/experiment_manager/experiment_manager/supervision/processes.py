"""The nodes of a run as processes that cannot outlive their parent."""

import ctypes
import os
import signal
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

from experiment_manager.run.progress_bar import TERMINAL_VARIABLE

PACKAGES = ("eye_plant", "sparse_coder", "vergence_rl", "experiment_manager")
MANAGER = "experiment_manager"
_PR_SET_PDEATHSIG = 1
_LIBC = ctypes.CDLL(None, use_errno=True)
_POLL_S = 0.02
# The recorder keeps pictures for one episode in some hundreds. What is this large glibc gives back
# when it is freed; from the heap it would stay, a little more of it each time.
_RECORDER_VARIABLES = {"MALLOC_MMAP_THRESHOLD_": str(1 << 16)}


def die_with(parent: int) -> None:
    """Ask the kernel for a SIGKILL when the parent dies, even if by kill -9 (Linux, prctl(2))."""
    _LIBC.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:
        os._exit(1)  # it died before we could ask


class NodeProcesses:
    """One process per package, each with a log of its own; stopped when the block is left."""

    def __init__(
        self,
        parameter_file: Path,
        domain: int,
        logs: Path,
        more: Mapping[str, Sequence[str]],
        packages: Sequence[str] = PACKAGES,
    ) -> None:
        """more: further command-line arguments by package; packages: which nodes to start."""
        logs.mkdir(parents=True, exist_ok=True)
        # The manager draws its progress bar where the supervisor writes; all else goes to the logs.
        # Under a number of its own, since the child's standard error is its log.
        terminal = os.dup(sys.stderr.fileno())
        environment = os.environ | {
            "ROS_DOMAIN_ID": str(domain),
            "PYTHONUNBUFFERED": "1",
            TERMINAL_VARIABLE: str(terminal),
        }
        self._processes: dict[str, subprocess.Popen[bytes]] = {}
        for package in packages:
            command = [sys.executable, "-m", f"{package}.node", "--ros-args"]
            command += ["--params-file", str(parameter_file), *more.get(package, ())]
            with (logs / f"{package}.log").open("ab") as log:
                self._processes[package] = subprocess.Popen(
                    command,
                    env=environment | (_RECORDER_VARIABLES if package == MANAGER else {}),
                    stdin=subprocess.DEVNULL,
                    stdout=log,
                    stderr=log,
                    pass_fds=(terminal,) if package == MANAGER else (),
                    # Ctrl-C in the terminal is for the supervisor alone.
                    start_new_session=True,
                    preexec_fn=partial(die_with, os.getpid()),  # noqa: PLW1509 (no threads yet)
                )
        os.close(terminal)

    def __enter__(self) -> "NodeProcesses":
        """Return the running processes."""
        return self

    def __exit__(self, *exception: object) -> None:
        """Stop them all."""
        self.stop()

    def exit_codes(self) -> dict[str, int]:
        """Return the exit codes of the processes that have ended, by package."""
        codes = {name: process.poll() for name, process in self._processes.items()}
        return {name: code for name, code in codes.items() if code is not None}

    def process_ids(self) -> dict[str, int]:
        """Return the process ids, by package."""
        return {name: process.pid for name, process in self._processes.items()}

    def interrupt_manager(self) -> None:
        """Ask the manager to end the run after the episode under way."""
        self._processes[MANAGER].send_signal(signal.SIGINT)

    def stop(self, patience_s: float = 3.0) -> None:
        """Ask each process to end, and kill those that do not, stopped ones among them."""
        running = [process for process in self._processes.values() if process.poll() is None]
        for process in running:
            process.terminate()
        end_s = time.monotonic() + patience_s
        while any(process.poll() is None for process in running) and time.monotonic() < end_s:
            time.sleep(_POLL_S)
        for process in running:
            if process.poll() is None:
                process.kill()
            process.wait()
