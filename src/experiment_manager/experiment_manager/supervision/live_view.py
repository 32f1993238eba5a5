"""The live view of a run as a process that the run does not depend on."""

import sys
from contextlib import AbstractContextManager
from pathlib import Path

from experiment_manager.live.address import Address
from experiment_manager.nodes import MANAGER
from experiment_manager.run.config_file import CONFIG_FILE, read_configuration
from experiment_manager.sections import TASK
from experiment_manager.supervision.processes import (
    Process,
    last_words,
    start_node,
    stop,
)
from lockstep.node.parameter_files import parameter_arguments

PACKAGE = "experiment_manager.live"


class LiveView(AbstractContextManager["LiveView"]):
    """The node live_view in a domain; stopped when the block is left, and never waited for."""

    def __init__(self, address: Address | None, domain: int, directory: Path) -> None:
        """address: None for none; directory: of the run."""
        self._log = directory / "logs" / "live_view.log"
        self._process: Process | None = None
        if address is None:
            return
        ports = {"port": address.port, "page_port": address.port + 1}
        config = str(directory / CONFIG_FILE)
        given = {"host": address.host, "run": _name_of(directory), **ports}
        arguments = ["--ros-args", "--params-file", config, *parameter_arguments(given)]
        self._process = start_node(PACKAGE, arguments, domain, self._log)

    def look(self) -> None:
        """Say so, once, when the process has ended by itself."""
        if self._process is None or self._process.poll() is None:
            return
        self._process = None
        print(
            f"the live view has ended: {last_words(self._log)}; the run continues", file=sys.stderr
        )

    def __exit__(self, *exception: object) -> None:
        """Stop the process."""
        if self._process is not None:
            stop([self._process])


def _name_of(directory: Path) -> str:
    """Return what a run is, for its page."""
    configuration = read_configuration(directory / CONFIG_FILE)
    manager = configuration[MANAGER]
    profile = f", profile {manager['profile']}" if manager["profile"] else ""
    return (
        f"{directory.name}{profile}, model {manager['model']}, seed {configuration[TASK]['seed']}"
    )
