"""What a process may ask of Linux for itself."""

import ctypes
import os
import signal
from collections.abc import Sequence
from pathlib import Path

_LIBC = ctypes.CDLL(None, use_errno=True)
_PR_SET_PDEATHSIG, _PR_SET_NAME = 1, 15
_M_MMAP_THRESHOLD = -3  # of mallopt(3)
# Where the command line lies: fields 48 and 49 of /proc/self/stat (proc(5)), the third one first.
_ARGUMENTS = slice(45, 47)


def die_with(parent: int) -> None:
    """Ask the kernel for a SIGKILL when the parent dies, even if by kill -9 (Linux, prctl(2))."""
    _LIBC.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:
        os._exit(1)  # it died before we could ask


def give_back_blocks_of(least_bytes: int) -> None:
    """Have glibc return blocks of memory of this size or more to the system when they are freed."""
    _LIBC.mallopt(_M_MMAP_THRESHOLD, least_bytes)


def appear_as(name: str, words: Sequence[str]) -> None:
    """Have ps, top and pkill show this process under a name, with another command line.

    The command line is written over the one that the process, or the one it was forked from, was
    started with, and cut where that ended.
    """
    _LIBC.prctl(_PR_SET_NAME, name.encode())
    fields = Path("/proc/self/stat").read_text().rpartition(")")[2].split()
    start, end = map(int, fields[_ARGUMENTS])
    line = b"\0".join(word.encode() for word in words)[: end - start - 1]
    ctypes.memmove(start, line.ljust(end - start, b"\0"), end - start)
