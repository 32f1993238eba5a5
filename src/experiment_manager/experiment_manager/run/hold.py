"""Who makes a run, so that nobody else on this machine does."""

import time
from contextlib import ExitStack
from pathlib import Path

from lockstep import InputError
from lockstep.machine.claims import claim

# What was killed a moment ago may still be ending.
_PATIENCE_S, _POLL_S = 3.0, 0.05


def hold(directory: Path) -> ExitStack:
    """Return the hold on the directory of a run, until it is closed.

    Raises InputError where another process has it, and OSError for a directory that is not there.
    """
    status = directory.stat()
    end_s = time.monotonic() + _PATIENCE_S
    while (holder := claim(f"run_{status.st_dev}_{status.st_ino}")) is None:
        if time.monotonic() > end_s:
            raise InputError(f"{directory}: expected a run at rest, another process is making it")
        time.sleep(_POLL_S)
    return holder
