"""Files that are there as a whole or not at all, after a kill or a loss of power."""

import contextlib
import os
import tempfile
from pathlib import Path

_PROBE_BYTES = 1 << 16


def replace_file(path: Path, content: bytes) -> None:
    """Write a file beside path, sync it and rename it to path, so that path is never half-written.

    The directory is synced too: after this, the content survives a loss of power.
    """
    beside = path.with_name(path.name + ".part")
    try:
        with beside.open("wb") as stream:
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
        beside.replace(path)
    except OSError:
        with contextlib.suppress(OSError):
            beside.unlink()
        raise
    sync_directory(path.parent)


def sync_directory(directory: Path) -> None:
    """Make renames and new names in a directory survive a loss of power."""
    handle = os.open(directory, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def is_free(directory: Path) -> bool:
    """Return whether a directory is new or empty, so that nothing in it can be overwritten."""
    return not directory.exists() or (directory.is_dir() and not any(directory.iterdir()))


def why_unwritable(directory: Path) -> str:
    """Return why nothing can be written into a directory, "" when it can."""
    try:
        with tempfile.TemporaryFile(dir=directory) as file:
            file.write(bytes(_PROBE_BYTES))
            file.flush()
            os.fsync(file.fileno())
    except OSError as error:
        return str(error)
    return ""
