"""Checkpoints: one manifest, renamed into place, commits the states of all nodes and the bag.

checkpoints/<place>/sparse_coder.npz, vergence_rl.npz    states, written by their nodes
checkpoints/<place>/manifest.json                        written last; without it, no checkpoint
"""

import hashlib
import shutil
from collections.abc import Collection
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec

from experiment_manager.measures.results import with_names_of_today
from experiment_manager.run.progress import ProgressState
from lockstep import InputError
from lockstep.files.durable_files import replace_file

_VERSION: Literal[3] = 3
_MANIFEST = "manifest.json"
# The newest one and, should its files prove damaged, the one before.
_N_KEPT = 2
_PLACE = "[0-9]" * 9


class Manifest(msgspec.Struct, frozen=True):
    """Everything that a resume needs besides the learners' states.

    place: episodes done, in the sequence of the protocol; parameters: of all nodes, by node, with
    which the run has been made; bag_files: those that are whole and belong to the run so far;
    state_hashes: SHA-256 by file name; progress: what the manager has counted up so far.
    """

    place: Annotated[int, msgspec.Meta(ge=0)]
    parameters: dict[str, dict[str, Any]]
    bag_files: tuple[str, ...]
    state_hashes: dict[Annotated[str, msgspec.Meta(pattern=r"^[^/]*$")], str]
    progress: ProgressState
    version: Literal[3] = _VERSION


def place_directory(checkpoints: Path, place: int) -> Path:
    """Return the directory of the checkpoint after so many episodes; it sorts by name."""
    return checkpoints / f"{place:09d}"


def hash_of(path: Path) -> str:
    """Return the SHA-256 of a file, in hexadecimal."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def commit(checkpoints: Path, manifest: Manifest, lasting: Collection[int] = ()) -> None:
    """Make the checkpoint of the states already written valid, then delete those before the last.

    Those at the places in lasting stay. What a kill left behind without a manifest is deleted too.

    Raises OSError when the disk refuses; then the older checkpoints are untouched.
    """
    write(checkpoints, manifest)
    kept = {place_directory(checkpoints, place) for place in lasting}
    # A link leads to a checkpoint of another run.
    own = {path for path in checkpoints.glob(_PLACE) if not path.is_symlink()}
    before = {path.parent for path in _manifests(checkpoints)[:-_N_KEPT]}
    for old in own & before - kept:
        # Without its manifest a half-deleted directory is no checkpoint.
        (old / _MANIFEST).unlink()
    for path in own:
        if not (path / _MANIFEST).exists():
            shutil.rmtree(path)


def write(checkpoints: Path, manifest: Manifest) -> None:
    """Write the manifest of states that are already there, whole."""
    path = place_directory(checkpoints, manifest.place) / _MANIFEST
    replace_file(path, msgspec.json.format(msgspec.json.encode(manifest), indent=1))


def places(checkpoints: Path) -> list[int]:
    """Return the episodes before each checkpoint that there is, rising."""
    return [int(path.parent.name) for path in _manifests(checkpoints)]


def everyone(checkpoints: Path) -> list[tuple[Manifest, Path]]:
    """Return all checkpoints with their directories, the oldest first; errors as for newest."""
    return [_checked(path) for path in _manifests(checkpoints)]


def newest(checkpoints: Path) -> tuple[Manifest, Path] | None:
    """Return the newest checkpoint and its directory, or None when there is none.

    Raises InputError for a manifest that is damaged or of another version, or whose state files
    are missing or changed.
    """
    found = _manifests(checkpoints)
    return _checked(found[-1]) if found else None


def at(checkpoints: Path, place: int) -> tuple[Manifest, Path]:
    """Return the checkpoint after so many episodes and its directory.

    Raises InputError, naming those that are there, when it is not; and as newest does.
    """
    path = place_directory(checkpoints, place) / _MANIFEST
    if not path.is_file():
        there = ", ".join(map(str, places(checkpoints))) or "none"
        raise InputError(
            f"{checkpoints}: expected a checkpoint after {place} episodes, there is one after "
            f"{there}"
        )
    return _checked(path)


def read(path: Path) -> Manifest:
    """Return a manifest; InputError for another thing, FileNotFoundError where it is gone."""
    try:
        return msgspec.json.decode(with_names_of_today(path.read_bytes()), type=Manifest)
    except FileNotFoundError:
        raise
    except (OSError, msgspec.DecodeError) as error:
        raise InputError(f"checkpoint {path}: expected a manifest: {error}") from error


def _manifests(checkpoints: Path) -> list[Path]:
    """Return those there are, in order; copies under names of somebody's own are none."""
    return sorted(checkpoints.glob(f"{_PLACE}/{_MANIFEST}"))


def _checked(path: Path) -> tuple[Manifest, Path]:
    manifest = read(path)
    for name, expected in manifest.state_hashes.items():
        state = path.parent / name
        if not state.is_file() or hash_of(state) != expected:
            raise InputError(
                f"checkpoint {path.parent}: {name} is missing or was changed; "
                "delete this directory to continue from the checkpoint before"
            )
    return manifest, path.parent
