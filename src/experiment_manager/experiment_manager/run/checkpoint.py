"""Checkpoints: one manifest, renamed into place, commits the states of all nodes and the bag.

checkpoints/<place>/sparse_coder.npz, vergence_rl.npz    states, written by their nodes
checkpoints/<place>/manifest.json                        written last; without it, no checkpoint
"""

import dataclasses
import hashlib
import json
import shutil
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lockstep import InputError
from lockstep.durable_files import replace_file

_VERSION = 2
_MANIFEST = "manifest.json"
# The newest one and, should its files prove damaged, the one before.
_N_KEPT = 2


@dataclass(frozen=True)
class Manifest:
    """Everything that a resume needs besides the learners' states.

    place: episodes done, in the sequence of the protocol; parameters: of all nodes, by node, with
    which the run has been made; bag_files: those that are whole and belong to the run so far;
    state_hashes: SHA-256 by file name; progress: what the manager has counted up so far.
    """

    place: int
    parameters: dict[str, dict[str, Any]]
    bag_files: tuple[str, ...]
    state_hashes: dict[str, str]
    progress: dict[str, Any]


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
    done = sorted(path.parent for path in checkpoints.glob(f"*/{_MANIFEST}"))
    kept = {place_directory(checkpoints, place) for place in lasting}
    for old in [path for path in done[:-_N_KEPT] if path not in kept]:
        # Without its manifest a half-deleted directory is no checkpoint.
        (old / _MANIFEST).unlink()
    for path in checkpoints.iterdir():
        if path.is_dir() and not (path / _MANIFEST).exists():
            shutil.rmtree(path)


def write(checkpoints: Path, manifest: Manifest) -> None:
    """Write the manifest of states that are already there, whole."""
    document = {"version": _VERSION, **dataclasses.asdict(manifest)}
    path = place_directory(checkpoints, manifest.place) / _MANIFEST
    replace_file(path, json.dumps(document, indent=1).encode())


def places(checkpoints: Path) -> list[int]:
    """Return the episodes before each checkpoint that there is, rising."""
    return sorted(int(path.parent.name) for path in checkpoints.glob(f"*/{_MANIFEST}"))


def everyone(checkpoints: Path) -> list[tuple[Manifest, Path]]:
    """Return all checkpoints with their directories, the oldest first; errors as for newest."""
    return [_checked(path) for path in sorted(checkpoints.glob(f"*/{_MANIFEST}"))]


def newest(checkpoints: Path) -> tuple[Manifest, Path] | None:
    """Return the newest checkpoint and its directory, or None when there is none.

    Raises InputError for a manifest that is damaged or of another version, or whose state files
    are missing or changed.
    """
    found = sorted(checkpoints.glob(f"*/{_MANIFEST}"))
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


def _checked(path: Path) -> tuple[Manifest, Path]:
    manifest = _read(path)
    for name, expected in manifest.state_hashes.items():
        state = path.parent / name
        if not state.is_file() or hash_of(state) != expected:
            raise InputError(
                f"checkpoint {path.parent}: {name} is missing or was changed; "
                "delete this directory to continue from the checkpoint before"
            )
    return manifest, path.parent


def _read(path: Path) -> Manifest:
    try:
        document = json.loads(path.read_bytes())
        version = document.pop("version")
        if version != _VERSION:
            raise InputError(f"checkpoint {path}: expected version {_VERSION}, got {version}")
        manifest = Manifest(**document)
    except InputError:
        raise
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(f"checkpoint {path}: expected a manifest: {error}") from error
    if not _is_sound(manifest):
        raise InputError(f"checkpoint {path}: expected a manifest, got other values: {manifest}")
    return dataclasses.replace(manifest, bag_files=tuple(manifest.bag_files))


def _is_sound(manifest: Manifest) -> bool:
    """Whether the values read are of the types that were written."""
    # As read from JSON: a list of bag files, and whatever somebody may have written instead.
    bag_files: Any = manifest.bag_files
    parameters: Any = manifest.parameters
    hashes: Any = manifest.state_hashes
    return (
        type(manifest.place) is int
        and manifest.place >= 0
        and isinstance(parameters, dict)
        and all(isinstance(values, dict) for values in parameters.values())
        and isinstance(bag_files, list)
        and all(isinstance(name, str) for name in bag_files)
        and isinstance(hashes, dict)
        and all(isinstance(h, str) and Path(name).name == name for name, h in hashes.items())
        and isinstance(manifest.progress, dict)
    )
