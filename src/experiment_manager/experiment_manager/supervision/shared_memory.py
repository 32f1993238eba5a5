"""Removes what killed nodes leave in shared memory; Fast DDS removes it only when a node ends well.

A participant keeps its data in a segment, /dev/shm/fastrtps_<16 hex digits>, and listens on ports,
fastrtps_port<number> with sem.fastrtps_port<number>_mutex. Beside each lies a file ..._el that its
owner holds locked (flock) while it lives.
"""

import os
import re
import time
from pathlib import Path

from lockstep.machine.domain import N_PORTS, first_port
from lockstep.machine.unfinished_ports import DIRECTORY, is_locked

_SEGMENT = re.compile(r"^(fastrtps_[0-9a-f]{16})(_el)?$")
# A file this young may belong to a node that is about to lock it.
_YOUNG_S = 5.0


def remove_stale_segments(directory: Path = DIRECTORY) -> int:
    """Remove the segments of this user's dead nodes, whatever their domain; return how many.

    No new process can open a removed segment; those that have it mapped keep it.
    """
    names = (path.name for path in directory.glob("fastrtps_*"))
    found = {match[1] for name in names if (match := _SEGMENT.match(name))}
    n_removed = 0
    for name in found:
        segment, lock = directory / name, directory / f"{name}_el"
        # One that died while it made the segment has no lock yet.
        if not _is_abandoned(lock if lock.exists() else segment):
            continue
        for path in (segment, lock):
            path.unlink(missing_ok=True)
        n_removed += 1
    return n_removed


def remove_ports(domain: int, directory: Path = DIRECTORY) -> int:
    """Remove the ports of a domain that was ours alone and has been left; return how many.

    In a domain with others, somebody may still send to a port whose listener died: leave those.
    """
    first = first_port(domain)
    n_removed = 0
    for number in range(first, first + N_PORTS):
        port = directory / f"fastrtps_port{number}"
        lock = directory / f"{port.name}_el"
        if not port.exists() or (lock.exists() and is_locked(lock)):
            continue
        for path in (port, lock, directory / f"sem.{port.name}_mutex"):
            path.unlink(missing_ok=True)
        n_removed += 1
    return n_removed


def _is_abandoned(path: Path) -> bool:
    try:
        status = path.stat()
    except FileNotFoundError:
        return False
    is_young = time.time() - status.st_mtime < _YOUNG_S
    return status.st_uid == os.getuid() and not is_young and not is_locked(path)
