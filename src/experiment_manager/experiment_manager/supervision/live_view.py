"""The live view of a run as a process that the run does not depend on."""

import sys
from contextlib import AbstractContextManager
from pathlib import Path

from experiment_manager.live.address import Address
from experiment_manager.run.config_file import CONFIG_FILE
from experiment_manager.supervision.fork_server import ForkServer, NodeProcess, stop
from experiment_manager.supervision.processes import last_words, parameter_arguments

PACKAGE = "experiment_manager.live"


class LiveView(AbstractContextManager["LiveView"]):
    """The node live_view in a domain; stopped when the block is left, and never waited for."""

    def __init__(
        self, fork_server: ForkServer, address: Address | None, domain: int, directory: Path
    ) -> None:
        """fork_server: starts it; address: None for none; directory: of the run."""
        self._log = directory / "logs" / "live_view.log"
        self._process: NodeProcess | None = None
        if address is None:
            return
        given = {"host": address.host, "port": address.port, "page_port": address.port + 1}
        config = str(directory / CONFIG_FILE)
        arguments = ["--ros-args", "--params-file", config, *parameter_arguments(given)]
        with self._log.open("ab") as log:
            self._process = fork_server.start(PACKAGE, arguments, domain, log)

    def look(self) -> None:
        """Say so, once, when the process has ended by itself."""
        if self._process is None or self._process.exit_code() is None:
            return
        self._process = None
        print(
            f"the live view has ended: {last_words(self._log)}; the run continues", file=sys.stderr
        )

    def __exit__(self, *exception: object) -> None:
        """Stop the process."""
        if self._process is not None:
            stop([self._process])
