"""The nodes of a run: started together, each with a log of its own, and stopped together."""

import signal
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from pathlib import Path

from experiment_manager.run.config_file import CONFIG_FILE
from experiment_manager.supervision.fork_server import ForkServer, NodeProcess, stop

PACKAGES = ("eye_plant", "sparse_coder", "vergence_rl", "experiment_manager")
MANAGER = "experiment_manager"


def parameter_arguments(values: Mapping[str, object]) -> list[str]:
    """Return the command-line arguments, behind --ros-args, that set parameters of a node."""
    return [word for name, value in values.items() for word in ("-p", f"{name}:={value}")]


def last_words(log: Path) -> str:
    """Return the last line of a log that is not blank."""
    lines = log.read_text(errors="replace").split("\n")
    return next((line for line in reversed(lines) if line.strip()), "without a word")


class NodeProcesses(AbstractContextManager["NodeProcesses"]):
    """One process per package; stopped when the block is left."""

    def __init__(
        self,
        fork_server: ForkServer,
        directory: Path,
        domain: int,
        more: Mapping[str, Sequence[str]],
        packages: Sequence[str],
    ) -> None:
        """Have the fork server start them; raises ConnectionError when it has ended.

        directory: of the run, with its config.yaml; more: further command-line arguments by
        package; packages: which nodes to start.
        """
        config, logs = directory / CONFIG_FILE, directory / "logs"
        logs.mkdir(parents=True, exist_ok=True)
        self._processes: dict[str, NodeProcess] = {}
        for package in packages:
            arguments = ["--ros-args", "--params-file", str(config), *more.get(package, ())]
            with (logs / f"{package}.log").open("ab") as log:
                self._processes[package] = fork_server.start(package, arguments, domain, log)

    def __exit__(self, *exception: object) -> None:
        """Stop them all."""
        stop(self._processes.values())

    def exit_codes(self) -> dict[str, int]:
        """Return the exit codes of the processes that have ended, by package."""
        codes = {name: process.exit_code() for name, process in self._processes.items()}
        return {name: code for name, code in codes.items() if code is not None}

    def interrupt_manager(self) -> None:
        """Ask the manager to end the run after the episode under way."""
        self._processes[MANAGER].signal(signal.SIGINT)
