"""Nodes that somebody starts one by one, without a supervisor."""

import os
import subprocess
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Self

from lockstep.machine.own_process import die_with


class LoneNodes:
    """One process per package, killed when the block is left."""

    def __init__(
        self, packages: Sequence[str], parameter_file: Path, domain: int, logs: Path
    ) -> None:
        """logs: the directory for one log each."""
        logs.mkdir(parents=True, exist_ok=True)
        self._processes = {}
        for package in packages:
            command = [sys.executable, "-m", f"{package}.node", "--ros-args"]
            with (logs / f"{package}.log").open("ab") as log:
                self._processes[package] = subprocess.Popen(
                    [*command, "--params-file", str(parameter_file)],
                    env=os.environ | {"ROS_DOMAIN_ID": str(domain), "PYTHONUNBUFFERED": "1"},
                    stdin=subprocess.DEVNULL,
                    stdout=log,
                    stderr=log,
                    preexec_fn=partial(die_with, os.getpid()),  # noqa: PLW1509 (it calls the kernel only)
                )

    def __enter__(self) -> Self:
        """Return the running processes."""
        return self

    def __exit__(self, *exception: object) -> None:
        """End them all."""
        for process in self._processes.values():
            process.kill()
            process.wait()

    def exit_codes(self) -> dict[str, int]:
        """Return the exit codes of the processes that have ended, by package."""
        codes = {name: process.poll() for name, process in self._processes.items()}
        return {name: code for name, code in codes.items() if code is not None}

    def process_ids(self) -> dict[str, int]:
        """Return the process ids, by package."""
        return {name: process.pid for name, process in self._processes.items()}
