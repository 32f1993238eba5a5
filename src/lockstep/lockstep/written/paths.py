"""Paths as people write them, on command lines and in files."""

import os
import re
from pathlib import Path


def written_path(text: str) -> Path:
    """Return the path that somebody wrote; `~` or `$HOME` at its start is the home directory.

    A shell leaves `~` alone behind `=` (--out=~/runs), and reads no sweep and no parameter.
    """
    return Path(os.path.expanduser(re.sub(r"^\$(HOME|\{HOME\})(?=/|$)", "~", text)))
