"""This user's folder for what can be made again."""

import os
from pathlib import Path

from lockstep.written.paths import written_path


def user_cache() -> Path:
    """Return the project's folder in it; it begins with ~ where nobody knows the home directory."""
    cache = os.environ.get("XDG_CACHE_HOME", "")
    if not os.path.isabs(cache):  # to be ignored, says the specification
        cache = "~/.cache"
    return written_path(f"{cache}/active_binocular_vision")
