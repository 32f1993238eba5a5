"""Locks on files, which the kernel releases with the last process that has the file open."""

import errno
import fcntl
import sys
from functools import cache
from pathlib import Path
from typing import IO

_NO_LOCKS = {
    errno.EACCES,
    errno.EINVAL,
    errno.ENOLCK,
    errno.ENOSYS,
    errno.EOPNOTSUPP,
    errno.EPERM,
}


def takes_lock(file: IO[bytes] | IO[str], *, shared: bool = False) -> bool:
    """Lock an open file if nobody holds a lock against that; return whether it is locked now.

    shared: against those that want it alone only. Where the file system has no locks (Lustre
    without its option flock, NFS without its lock daemon) everybody gets them, with one warning.
    """
    try:
        fcntl.flock(file, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError as error:
        if error.errno not in _NO_LOCKS:
            raise
        _warn(Path(file.name).parent, error.strerror)
    return True


@cache
def _warn(directory: Path, reason: str) -> None:
    print(
        f"warning: {directory}: no locks on this file system (flock: {reason}), so nothing keeps "
        "two processes from doing the same work here: start it once at a time",
        file=sys.stderr,
    )
