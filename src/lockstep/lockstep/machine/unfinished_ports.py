"""Removes the shared-memory ports that nobody will ever finish making.

A port of Fast DDS is /dev/shm/fastrtps_port<number>; beside it lies a file ..._el, which its owner
holds locked (flock) while it lives. Its first word becomes 2 when it is made, or 3 when that
failed. Who opens it before waits for that, for ever and deaf to signals: a process that is killed
meanwhile would hang every node that starts later on this machine, since all of them open port 7000.
"""

import contextlib
import re
import time
from collections.abc import Callable
from pathlib import Path

from lockstep.errors import InputError
from lockstep.machine.locks import takes_lock

DIRECTORY = Path("/dev/shm")
# Making one takes microseconds, so that a machine with far too much to do still gets there.
PATIENCE_S = 5.0
_PORT = re.compile(r"^fastrtps_port[0-9]+$")
_UNFINISHED = ((), (0,), (1,))  # the first word: not there yet, or a state of boost::interprocess
_WORD_BYTES = 4


def remove_unfinished_ports(
    directory: Path = DIRECTORY, wait: Callable[[float], None] = time.sleep
) -> int:
    """Remove the ports that are still unfinished after PATIENCE_S; return how many.

    wait: spends so many seconds; called only when there is such a port. Raises InputError for one
    that stays: another user's, or one whose lock a living process holds.
    """
    before = unfinished_ports(directory)
    if not before:
        return 0
    wait(PATIENCE_S)
    dead = [
        path for path, number in unfinished_ports(directory).items() if before.get(path) == number
    ]
    for path in dead:
        if is_locked(path.with_name(f"{path.name}_el")):
            raise InputError(_complaint(path, "a living process holds its lock; end that one"))
        try:
            path.unlink(missing_ok=True)
        except OSError as error:
            reason = f"it cannot be removed: {error.strerror}; remove it as user {_owner(path)}"
            raise InputError(_complaint(path, reason)) from error
    return len(dead)


def is_locked(lock: Path) -> bool:
    """Return whether a process holds a lock file locked."""
    with contextlib.suppress(FileNotFoundError, PermissionError), lock.open("rb") as file:
        return not takes_lock(file)
    return False


def unfinished_ports(directory: Path = DIRECTORY) -> dict[Path, int]:
    """Return the inode number of each unfinished port."""
    found = {}
    for path in directory.iterdir() if directory.is_dir() else ():
        if not _PORT.match(path.name):
            continue
        with contextlib.suppress(FileNotFoundError, PermissionError), path.open("rb") as file:
            if tuple(file.read(_WORD_BYTES)[:1]) in _UNFINISHED:
                found[path] = path.stat().st_ino
    return found


def _complaint(path: Path, reason: str) -> str:
    return (
        f"{path}: expected a port of Fast DDS that is finished, got one whose process died; every "
        f"node on this machine would wait for it, but {reason}"
    )


def _owner(path: Path) -> str:
    try:
        return path.owner()
    except KeyError:
        return str(path.stat().st_uid)
