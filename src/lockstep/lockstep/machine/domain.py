"""The ROS domain that the environment names."""

import os

from lockstep.errors import InputError

# RTPS 2.2, 9.6.1.1: the last one whose ports exist.
LAST_DOMAIN = 232


def given_domain() -> int | None:
    """Return ROS_DOMAIN_ID, None when it is not set; raise InputError when it is no domain."""
    given = os.environ.get("ROS_DOMAIN_ID", "")
    if given and (not (given.isascii() and given.isdigit()) or int(given) > LAST_DOMAIN):
        raise InputError(
            f"ROS_DOMAIN_ID: expected a whole number 0 to {LAST_DOMAIN}, got {given!r}"
        )
    return int(given) if given else None
