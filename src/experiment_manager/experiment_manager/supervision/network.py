"""Whether nodes began without a network that is there now: others know no way to such nodes."""


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
