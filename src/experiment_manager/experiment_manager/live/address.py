"""Where the live view listens."""

import argparse
from dataclasses import dataclass

from experiment_manager.live.config import LOCAL_HOST, PORT


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
