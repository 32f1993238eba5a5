"""What a process may ask of Linux for itself."""

import ctypes
import os
import signal

_LIBC = ctypes.CDLL(None, use_errno=True)
_PR_SET_PDEATHSIG = 1
_M_MMAP_THRESHOLD = -3  # of mallopt(3)


def die_with(parent: int) -> None:
    """Ask the kernel for a SIGKILL when the parent dies, even if by kill -9 (Linux, prctl(2))."""
    _LIBC.prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:
        os._exit(1)  # it died before we could ask


def give_back_blocks_of(least_bytes: int) -> None:
    """Have glibc return blocks of memory of this size or more to the system when they are freed."""
    _LIBC.mallopt(_M_MMAP_THRESHOLD, least_bytes)
