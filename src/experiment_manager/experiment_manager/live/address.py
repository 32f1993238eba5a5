"""Where the live view listens."""

import argparse
import ipaddress
import re
import socket
from dataclasses import dataclass
from typing import Any

from experiment_manager.live.config import LOCAL_HOST, PORT
from lockstep import InputError
from lockstep.written.yaml_text import yaml_line

# [IPv6]:PORT; PORT; HOST:PORT; each part may be missing.
_FORMS = re.compile(r"\[(?P<six>[^]]*)\](:(?P<a>.*))?|(?P<b>\d+)|(?P<host>[^:]*)(:(?P<c>[^:]*))?")


@dataclass(frozen=True)
class Address:
    """Where the live view listens; its page is on the next port."""

    host: str = LOCAL_HOST
    port: int = PORT

    @classmethod
    def of(cls, text: str) -> "Address":
        """Return the address that HOST, PORT, HOST:PORT or :PORT names; for argparse.

        An IPv6 host stands in brackets where a port follows.
        """
        found = _FORMS.fullmatch(f"[{text}]" if _is_ipv6(text) else text)
        if found is not None:
            six, host = found["six"], found["host"]
            port = found["a"] or found["b"] or found["c"] or str(PORT)
            is_port = re.fullmatch("[0-9]{1,5}", port) and 0 < int(port) < 65535
            if is_port and (six is None or _is_ipv6(six)):
                return cls(six or host or LOCAL_HOST, int(port))
        raise argparse.ArgumentTypeError(
            "expected HOST, PORT or HOST:PORT with a port from 1 to 65534 and an IPv6 host in "
            f"brackets, such as [::1]:9000, got {text!r}"
        )

    def check(self) -> None:
        """Raise InputError unless both ports can be listened on now."""
        yaml_line(self.host)  # refuses what no node could be told
        for port in (self.port, self.port + 1):
            try:
                family, kind, _, _, place = resolved(self.host, port)
                with socket.socket(family, kind) as probe:
                    probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
                    probe.bind(place)
            except (OSError, UnicodeError) as error:
                raise InputError(
                    f"--live: expected an address of this machine with two free ports, "
                    f"got {Address(self.host, port)}: {error}"
                ) from error

    def __str__(self) -> str:
        """Return HOST:PORT, as in a URL."""
        return f"[{self.host}]:{self.port}" if ":" in self.host else f"{self.host}:{self.port}"


def resolved(
    host: str, port: int
) -> tuple[socket.AddressFamily, socket.SocketKind, int, str, tuple[Any, ...]]:
    """Return family, kind, protocol, name and place of a host to listen on, as getaddrinfo does.

    Raises OSError or UnicodeError for one that nobody knows.
    """
    flags = socket.AI_PASSIVE
    return socket.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=flags)[0]


def _is_ipv6(text: str) -> bool:
    try:
        return ipaddress.ip_address(text).version == 6
    except ValueError:
        return False
