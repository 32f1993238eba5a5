"""The nodes of a run: started together, each with a log of its own, and stopped together."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Collection, Mapping, Sequence
from contextlib import AbstractContextManager
from functools import partial
from pathlib import Path

from experiment_manager.nodes import MANAGER
from experiment_manager.run.config_file import CONFIG_FILE
from experiment_manager.run.progress_bar import TERMINAL_VARIABLE
from lockstep.machine import start
from lockstep.machine.own_process import die_with

_POLL_S, _PATIENCE_S = 0.02, 3.0

Process = subprocess.Popen[bytes]


def last_words(log: Path) -> str:
    """Return the last line of a log that is not blank."""
    lines = log.read_text(errors="replace").split("\n")
    return next((line for line in reversed(lines) if line.strip()), "without a word")


def start_node(package: str, arguments: Sequence[str], domain: int, log: Path) -> Process:
    """Start the node of a package, its module `node`, which dies with this process.

    domain: its ROS_DOMAIN_ID; log: where its output is appended. What is this process' standard
    error it finds under the number in TERMINAL_VARIABLE. Ctrl-C in the terminal does not reach it.
    """
    terminal = os.dup(2)
    try:
        with log.open("ab") as output:
            return subprocess.Popen(
                [sys.executable, "-m", start.__name__, f"{package}.node", *arguments],
                env=os.environ | {"ROS_DOMAIN_ID": str(domain), TERMINAL_VARIABLE: str(terminal)},
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=output,
                pass_fds=[terminal],
                start_new_session=True,
                preexec_fn=partial(die_with, os.getpid()),  # noqa: PLW1509 (it calls the kernel only)
            )
    finally:
        os.close(terminal)


def stop(processes: Collection[Process]) -> None:
    """Ask each to end, and kill those that do not, stopped ones among them."""
    end_s = time.monotonic() + _PATIENCE_S
    for process in processes:
        process.terminate()
    while any(process.poll() is None for process in processes):
        if time.monotonic() > end_s:
            for process in processes:
                process.kill()
        time.sleep(_POLL_S)


class NodeProcesses(AbstractContextManager["NodeProcesses"]):
    """One process per package; stopped when the block is left."""

    def __init__(
        self,
        directory: Path,
        domain: int,
        more: Mapping[str, Sequence[str]],
        packages: Sequence[str],
    ) -> None:
        """Start them.

        directory: of the run, with its config.yaml; more: further command-line arguments by
        package; packages: which nodes to start.
        """
        config, logs = directory / CONFIG_FILE, directory / "logs"
        logs.mkdir(parents=True, exist_ok=True)
        self._processes: dict[str, Process] = {}
        for package in packages:
            arguments = ["--ros-args", "--params-file", str(config), *more.get(package, ())]
            log = logs / f"{package}.log"
            self._processes[package] = start_node(package, arguments, domain, log)

    def __exit__(self, *exception: object) -> None:
        """Stop them all."""
        stop(self._processes.values())

    def exit_codes(self) -> dict[str, int]:
        """Return how the processes that have ended did, by package: a signal as its negative."""
        codes = {name: process.poll() for name, process in self._processes.items()}
        return {name: code for name, code in codes.items() if code is not None}

    def interrupt_manager(self) -> None:
        """Ask the manager to end the run after the episode under way; also in a signal handler."""
        self._processes[MANAGER].send_signal(signal.SIGINT)
