"""Whether nodes began without a network that is there now: others know no way to such nodes."""

import socket

import psutil


def addresses() -> frozenset[str]:
    """Return the IPv4 addresses of this machine's interfaces that work now, loopback too.

    Fast DDS tells others the addresses that it finds when a node starts. A sandbox without netlink
    has none.
    """
    try:
        found = psutil.net_if_addrs()
    except OSError:
        return frozenset()
    try:
        works = {name for name, state in psutil.net_if_stats().items() if state.isup}
    except OSError:  # without /proc; then all of them count
        works = set(found)
    return frozenset(
        address.address
        for name, of_interface in found.items()
        for address in of_interface
        if name in works and address.family == socket.AF_INET
    )


class Network:
    """The addresses of this machine since the nodes of an attempt were started."""

    def __init__(self, addresses: frozenset[str]) -> None:
        """addresses: as the nodes are started."""
        self._first = self._fewest = addresses

    def is_back(self, addresses: frozenset[str], *, all_began: bool, met: bool) -> bool:
        """Return whether nodes may have begun without one of the addresses there are now.

        To be called now and then. all_began: all nodes have said something; met: so have those
        elsewhere. When they have, an address that is new is somebody else's affair, but not one
        that was gone while nodes began.
        """
        if not all_began:
            self._fewest &= addresses
        returned = (self._first - self._fewest) & addresses
        return bool(returned) or not (met or addresses <= self._fewest)
