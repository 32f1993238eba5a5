"""A ROS domain of our own: no other run's messages get in, and ours get to nobody."""

import socket
from collections.abc import Iterator
from contextlib import contextmanager

from lockstep import InputError
from lockstep.machine.claims import claim

# Domains 0 to 101 stay below Linux' ephemeral ports; 0 and the documented one of nodes that are
# started one by one are everybody's.
NODE_SCRIPTS_DOMAIN = 42
_CANDIDATES = tuple(d for d in range(1, 102) if d != NODE_SCRIPTS_DOMAIN)
# RTPS 2.2, 9.6.1.1: the ports of a domain, and those two on which each participant receives. Those
# who came first may have left; of more than this_machine.xml allows for, some never meet.
_FIRST_PORT, _PORTS_PER_DOMAIN = 7400, 250
_UNICAST_OFFSETS = range(10, 10 + 2 * 32)


@contextmanager
def own_domain(avoid: frozenset[int] = frozenset()) -> Iterator[int]:
    """Yield a domain that nobody on this machine uses.

    avoid: domains not to take again. A claim keeps two runs that start at once apart until the
    block is left. Raises InputError when none is free.
    """
    for domain in _CANDIDATES:
        if domain in avoid:
            continue
        # In a sandbox without such names the ports alone show who is here.
        if (holder := claim(f"ros_domain_{domain}")) is None:
            continue
        with holder:
            if not is_silent(domain):
                continue
            yield domain
            return
    raise InputError("expected a free ROS domain between 1 and 101, all are in use")


def is_silent(domain: int) -> bool:
    """Return whether nobody on this machine is in the domain."""
    for offset in _UNICAST_OFFSETS:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                probe.bind(("", _FIRST_PORT + _PORTS_PER_DOMAIN * domain + offset))
            except OSError:
                return False
    return True
