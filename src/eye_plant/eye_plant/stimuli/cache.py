"""Generated stimuli on disk: drawn once, afterwards mapped into memory as they are."""

import math
import os
import threading
from functools import partial
from pathlib import Path

import numpy as np

from eye_plant.stimuli import generator as stimulus_generator
from lockstep import InputError
from lockstep.files.mapped_files import map_bytes
from lockstep.files.user_cache import user_cache
from lockstep.machine.threads import map_in_threads
from lockstep.written.paths import written_path

# Of the generated pictures. Another one when the generator, or a library that it uses, gives other
# bytes: a test knows what version 1 gives.
_VERSION = 1
# NumPy parses headers with `ast`, which in Python 3.11 two threads must not do at once (CPython
# issue 106905).
_PARSING = threading.Lock()


class FileArray(np.ndarray):
    """The array of a file; path: the file's, None of what is made out of the array."""

    path: Path | None = None


def load_generated(
    cache_directory: str, seed: int, role: str, n: int, size_px: int
) -> tuple[np.ndarray, ...]:
    """Return pictures 0 to n - 1 of the set `role`, each (size_px, size_px) uint8, read only.

    Those that the cache lacks are generated and added, each by one rename, so that an interrupted
    or a second process does no harm. The arrays are memory maps of the files: they cost memory
    only where they are read. Raises InputError when the cache cannot be written.
    """
    directory = _set_directory(cache_directory, seed, size_px)
    try:
        directory.mkdir(parents=True, exist_ok=True)
        load = partial(_load_one, directory, seed, role, size_px=size_px)
        # NumPy and OpenCV let other threads run meanwhile.
        return tuple(map_in_threads(load, range(n)))
    except OSError as error:
        raise _unusable(directory, error) from error


def n_missing(cache_directory: str, seed: int, role: str, n: int, size_px: int) -> int:
    """Return how many pictures `load_generated` would have to draw."""
    directory = _set_directory(cache_directory, seed, size_px)
    return sum(not os.path.exists(_path(directory, role, number)) for number in range(n))


def _path(directory: Path, role: str, number: int) -> Path:
    return directory / f"{role}_{number:04d}.npy"


def _set_directory(cache_directory: str, seed: int, size_px: int) -> Path:
    """Return the directory of one set; InputError for ~ where nobody knows the home directory."""
    root = written_path(cache_directory) if cache_directory else user_cache() / "stimuli"
    if root.parts[:1] == ("~",):
        raise _unusable(root, "this user has no home directory")
    return root / f"v{_VERSION}-seed{seed}-{size_px}px"


def _unusable(directory: Path, reason: object) -> InputError:
    return InputError(
        f"stimuli.cache_directory: expected a directory to write to, got {directory} ({reason}); "
        "XDG_CACHE_HOME=DIR or --set eye_plant.stimuli.cache_directory=DIR names another one"
    )


def _load_one(directory: Path, seed: int, role: str, number: int, size_px: int) -> np.ndarray:
    path = _path(directory, role, number)
    picture = map_array(path, (size_px, size_px))
    if picture is None:
        made = stimulus_generator.generate_stimulus(seed, role, number, size_px)
        picture = write_array(path, made)
    return picture


def map_array(path: Path, shape: tuple[int, ...]) -> np.ndarray | None:
    """Return the array of uint8 in a file, mapped; None when there is none of that shape in it."""
    try:
        with path.open("rb") as file:
            if np.lib.format.read_magic(file) != (1, 0):
                return None
            with _PARSING:
                found, is_by_column, kind = np.lib.format.read_array_header_1_0(file)
            first = file.tell()
            texels = map_bytes(file)[first:]
    except (OSError, ValueError):
        return None
    if found != shape or is_by_column or kind != np.uint8 or texels.size != math.prod(shape):
        return None
    array = texels.reshape(shape).view(FileArray)
    array.path = path
    return array


def write_array(path: Path, array: np.ndarray) -> np.ndarray:
    """Write an array of uint8 by one rename, so that nobody finds a part, and return it mapped.

    Raises OSError.
    """
    # Another thread's or process's part is not this one's; the mode is that of any new file.
    part = path.with_name(f".{path.name}.{os.getpid()}-{threading.get_ident()}")
    try:
        with part.open("wb") as file:
            np.save(file, array)
        part.replace(path)
    except OSError:
        part.unlink(missing_ok=True)
        raise
    mapped = map_array(path, array.shape)
    return array if mapped is None else mapped
