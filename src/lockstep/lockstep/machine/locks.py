"""Locks on files, which the kernel releases with the last process that has the file open."""

import fcntl
from typing import IO


def takes_lock(file: IO[bytes] | IO[str], *, shared: bool = False) -> bool:
    """Lock an open file if nobody holds a lock against that; return whether it is locked now.

    shared: against those that want it alone only.
    """
    try:
        fcntl.flock(file, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True
