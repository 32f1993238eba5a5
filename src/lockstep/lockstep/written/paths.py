"""Paths as people write them, on command lines and in files."""

import os
import re
from pathlib import Path

from lockstep.errors import InputError


def written_path(text: str) -> Path:
    """Return the path that somebody wrote; `~` or `$HOME` at its start is the home directory.

    A shell leaves `~` alone behind `=` (--out=~/runs), and reads no sweep and no parameter. Raises
    InputError for no text, as a shell has it of a variable that is not set.
    """
    if not text:
        raise InputError("expected a path, got ''")
    return Path(os.path.expanduser(re.sub(r"^\$(HOME|\{HOME\})(?=/|$)", "~", text)))
