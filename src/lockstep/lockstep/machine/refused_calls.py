"""Calls of the kernel that some file systems, containers and sandboxes lack or forbid."""

import errno
from collections.abc import Iterator
from contextlib import contextmanager

# What is said of a call that is sound in itself: it is not there, not for this kind of file, or not
# allowed here. A disk that fails or is full says something else.
_REFUSALS = frozenset(
    (
        errno.EACCES,
        errno.EBADF,
        errno.EINVAL,
        errno.EISDIR,
        errno.ENODEV,
        errno.ENOLCK,
        errno.ENOSYS,
        errno.ENOTTY,
        errno.EOPNOTSUPP,
        errno.EPERM,
    )
)


@contextmanager
def left_out_if_refused() -> Iterator[None]:
    """Leave out the rest of the block when the system refuses a call that can be done without.

    Any other OSError is raised.
    """
    try:
        yield
    except OSError as error:
        if error.errno not in _REFUSALS:
            raise
