"""What the environment says of ROS, and the domain that it names."""

import os

from lockstep.errors import InputError
from lockstep.machine.environment import adopt, why_refused

# RTPS 2.2, 9.6.1.1: the last one whose ports exist.
LAST_DOMAIN = 232
# Where nodes that people start one by one meet.
DOMAIN_OF_SINGLE_NODES = 42


def enter_environment() -> None:
    """Make the environment that of a node; raise InputError where no node could work in it."""
    given_domain()
    adopt()
    if why := why_refused():
        raise InputError(why)


def given_domain() -> int | None:
    """Return ROS_DOMAIN_ID, None when it is not set; raise InputError when it is no domain."""
    given = os.environ.get("ROS_DOMAIN_ID", "")
    if given and given not in map(str, range(LAST_DOMAIN + 1)):  # ROS reads 010 as 8
        raise InputError(
            f"ROS_DOMAIN_ID: expected a whole number 0 to {LAST_DOMAIN}, got {given!r}"
        )
    return int(given) if given else None
