"""A directory of the user's own pictures: which files are used."""

import os
from pathlib import Path

from lockstep import InputError, generator
from lockstep.written.paths import written_path

SUFFIXES = (".bmp", ".jpeg", ".jpg", ".pgm", ".png", ".ppm", ".tif", ".tiff", ".webp")
_NOTES = (".md", ".txt")  # may stand beside the pictures


def choose_files(
    directory: str, seed: int, n_training: int, n_test: int
) -> tuple[tuple[Path, ...], tuple[Path, ...]]:
    """Return up to n_training and n_test files of the directory, chosen by the seed, disjoint.

    With subdirectories train and test each gives its own; otherwise all files are shuffled and
    split, in the proportion n_training : n_test when there are fewer than both together, at least
    one each. The order of names on disk does not matter. Raises InputError naming the directory
    that is missing, holds too few pictures or something that is no picture.
    """
    root = _root(directory)
    parts = {name: root / name for name in ("train", "test")}
    if any(map(os.path.isdir, parts.values())):
        training = _shuffled(_pictures_in(parts["train"], 1), seed, "train")[:n_training]
        return training, _shuffled(_pictures_in(parts["test"], 1), seed, "test")[:n_test]
    files = _shuffled(_pictures_in(root, 2), seed, "split")
    n_chosen = min(len(files), n_training + n_test)
    share = round(n_chosen * n_test / (n_training + n_test))
    n_test_chosen = min(max(share, 1), n_chosen - 1)
    n_training_chosen = n_chosen - n_test_chosen
    return files[:n_training_chosen], files[n_training_chosen:n_chosen]


def choose_test_files(directory: str, seed: int) -> tuple[Path, ...]:
    """Return the files of a directory's subdirectory test, or all files if it has none.

    In the order in which choose_files gives those of a subdirectory test. Raises InputError naming
    the directory that is missing, empty or holds something that is no picture.
    """
    root = _root(directory)
    part = root / "test"
    return _shuffled(_pictures_in(part if os.path.isdir(part) else root, 1), seed, "test")


def _root(directory: str) -> Path:
    root = written_path(directory)
    if not os.path.isdir(root):
        raise InputError(f"stimuli.directory: expected a directory of images, got {directory}")
    return root


def _pictures_in(directory: Path, least: int) -> list[Path]:
    """Return the picture files of a directory by name; hidden files and notes are no pictures."""
    if not os.path.isdir(directory):
        raise InputError(f"stimuli.directory: expected both train and test, got no {directory}")
    try:
        found = sorted(directory.iterdir())
    except OSError as error:
        raise InputError(f"{directory}: expected images, got {error.strerror}") from error
    pictures: list[Path] = []
    others: list[str] = []
    for path in found:
        suffix = path.suffix.lower()
        if path.name.startswith(".") or suffix in _NOTES:
            continue
        if os.path.islink(path) and not os.path.exists(path):
            others.append(f"{path.name} (a link to {os.readlink(path)} that leads nowhere)")
        elif os.path.isfile(path) and suffix in SUFFIXES:
            pictures.append(path)
        elif os.path.isfile(path):
            others.append(path.name)
    kinds = ", ".join(SUFFIXES)
    if others:
        raise InputError(f"{directory}: expected images ({kinds}), got {', '.join(others)}")
    if len(pictures) < least:
        raise InputError(
            f"{directory}: expected {least} or more images ({kinds}), got {len(pictures)}"
        )
    return pictures


def _shuffled(paths: list[Path], seed: int, role: str) -> tuple[Path, ...]:
    order = generator(seed, f"stimulus directory {role}", 0).permutation(len(paths))
    return tuple(paths[i] for i in order)
