"""A learner's state on disk: named arrays in one file that is there whole or not at all."""

import io
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from lockstep.errors import InputError
from lockstep.files.durable_files import replace_file

_VERSION = 1
_KIND, _FORMAT = "__kind__", "__version__"


def write_state(path: Path, kind: str, state: Mapping[str, np.ndarray]) -> None:
    """Write named arrays; kind says whose state it is. The file appears when it is complete.

    Raises OSError when the disk refuses; then an older file is untouched.
    """
    content = io.BytesIO()
    arrays = {_KIND: np.array(kind), _FORMAT: np.array(_VERSION), **state}
    np.savez_compressed(content, allow_pickle=False, **arrays)
    replace_file(path, content.getvalue())


def read_state(path: Path, kind: str) -> dict[str, np.ndarray]:
    """Return the arrays that `write_state` wrote for the same kind.

    Raises InputError for a missing, cut-off, corrupt, foreign or differently versioned file.
    """
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
    except Exception as error:  # zip, zlib, numpy and its tokenizer raise errors of their own
        raise InputError(f"state file {path}: expected a state of {kind}: {error}") from error
    found, version = arrays.pop(_KIND, None), arrays.pop(_FORMAT, None)
    if found is None or version is None or str(found) != kind or str(version) != str(_VERSION):
        raise InputError(
            f"state file {path}: expected a state of {kind}, version {_VERSION}; "
            f"got {found}, version {version}"
        )
    return arrays
