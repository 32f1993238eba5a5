"""The live view of a run as a process that the run does not depend on."""

import argparse
import sys
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path

from experiment_manager.live.config import LOCAL_HOST, PORT
from experiment_manager.run.config_file import read_configuration
from experiment_manager.run.run_directory import CONFIG_FILE
from experiment_manager.supervision.fork_server import ForkServer, NodeProcess, stop

PACKAGE = "experiment_manager.live"


@dataclass(frozen=True)
class Address:
    """Where the live view listens; its page is on the next port."""

    host: str = LOCAL_HOST
    port: int = PORT

    @classmethod
    def of(cls, text: str) -> "Address":
        """Return the address that HOST, HOST:PORT or :PORT names; for argparse."""
        host, _, port = text.partition(":")
        if port and not (port.isdigit() and 0 < int(port) < 65535):
            raise argparse.ArgumentTypeError(
                f"expected HOST:PORT with a port from 1 to 65534, got {text!r}"
            )
        return cls(host or LOCAL_HOST, int(port or PORT))

    def __str__(self) -> str:
        """Return HOST:PORT."""
        return f"{self.host}:{self.port}"


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
        coder = read_configuration(directory / CONFIG_FILE)["sparse_coder"]
        given = {
            "host": address.host,
            "port": address.port,
            "page_port": address.port + 1,
            "n_selections": coder["n_selections"],
        }
        arguments = [word for name, value in given.items() for word in ("-p", f"{name}:={value}")]
        with self._log.open("ab") as log:
            self._process = fork_server.start(
                PACKAGE, ["--ros-args", *arguments], {"ROS_DOMAIN_ID": str(domain)}, log
            )

    def look(self) -> None:
        """Say so, once, when the process has ended by itself."""
        if self._process is None or self._process.exit_code() is None:
            return
        self._process = None
        lines = self._log.read_text(errors="replace").splitlines()
        reason = next((line for line in reversed(lines) if line.strip()), "without a word")
        print(f"the live view has ended: {reason}; the run goes on", file=sys.stderr)

    def __exit__(self, *exception: object) -> None:
        """Stop the process."""
        if self._process is not None:
            stop([self._process])
