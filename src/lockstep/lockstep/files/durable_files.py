"""Files that are there as a whole or not at all, after a kill or a loss of power."""

import contextlib
import errno
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import IO, BinaryIO

_PROBE_BYTES = 1 << 16
# How file systems say that they lack fsync, as CIFS and some in user space do for directories, or
# that it is not allowed. A disk that fails or is full says something else.
_NO_SYNC = (
    *(errno.EACCES, errno.EBADF, errno.EINVAL, errno.EISDIR, errno.ENOSYS, errno.ENOTTY),
    *(errno.EOPNOTSUPP, errno.EPERM),
)


def replace_file(path: Path, content: bytes) -> None:
    """Write a file as `replacement_of` does."""
    with replacement_of(path) as stream:
        stream.write(content)


@contextlib.contextmanager
def replacement_of(path: Path) -> Iterator[BinaryIO]:
    """Yield a file beside path, synced and renamed to path at the end: it is never half-written.

    The directory is synced too: after this, the content survives a loss of power. When the block or
    the disk raises something, path is as it was and nothing lies beside it.
    """
    beside = _beside(path)
    try:
        with beside.open("wb") as stream:
            yield stream
            sync(stream)
        beside.replace(path)
    except BaseException:
        with contextlib.suppress(OSError):
            beside.unlink()
        raise
    sync_directory(path.parent)


def _beside(path: Path) -> Path:
    return path.with_name(path.name + ".part")


@contextlib.contextmanager
def first_to_make(path: Path) -> Iterator[None]:
    """Let only one process make a file, by `replace_file` in this block, on any file system.

    Raises FileExistsError where it is there, or another one is about to make it.
    """
    _beside(path).open("xb").close()
    try:
        if path.exists():
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), str(path))
        yield
    finally:
        with contextlib.suppress(OSError):
            _beside(path).unlink()


def sync(file: IO[bytes]) -> None:
    """Make what was written to a file survive a loss of power, where its file system can do so."""
    file.flush()
    with _where_there_is_sync():
        os.fsync(file.fileno())


def sync_directory(directory: Path) -> None:
    """Make renames and new names in a directory survive a loss of power, as far as `sync` can."""
    with _where_there_is_sync():
        handle = os.open(directory, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


@contextlib.contextmanager
def _where_there_is_sync() -> Iterator[None]:
    try:
        yield
    except OSError as error:
        if error.errno not in _NO_SYNC:
            raise


def is_free(directory: Path) -> bool:
    """Return whether a directory is new or empty, so that nothing in it can be overwritten."""
    return not directory.exists() or (directory.is_dir() and not any(directory.iterdir()))


def why_unwritable(directory: Path) -> str:
    """Return why nothing can be written into a directory, "" when it can."""
    try:
        with tempfile.TemporaryFile(dir=directory) as file:
            file.write(bytes(_PROBE_BYTES))
            sync(file)
    except OSError as error:
        return str(error)
    return ""
