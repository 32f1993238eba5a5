"""A directory of the user's own pictures: which ones, and how each becomes a stimulus."""

from pathlib import Path

import cv2
import numpy as np

from lockstep import InputError, generator
from lockstep.paths import written_path

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
    if any(part.is_dir() for part in parts.values()):
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
    return _shuffled(_pictures_in(part if part.is_dir() else root, 1), seed, "test")


def _root(directory: str) -> Path:
    root = written_path(directory)
    if not root.is_dir():
        raise InputError(f"stimuli.directory: expected a directory of pictures, got {directory}")
    return root


def read_picture(path: Path, size_px: int, smallest_px: int) -> np.ndarray:
    """Return the central square of a picture file, grey, (size_px, size_px) uint8.

    Reduced by area averaging, enlarged bilinearly. Raises InputError naming a file that cannot be
    decoded to its end or whose shorter side is below smallest_px.
    """
    grey = _decoded(path)
    height_px, width_px = grey.shape
    side_px = min(height_px, width_px)
    if side_px < smallest_px:
        raise InputError(
            f"{path}: expected a picture of {smallest_px} x {smallest_px} px or more, "
            f"got {width_px} x {height_px}"
        )
    top, left = (height_px - side_px) // 2, (width_px - side_px) // 2
    square = grey[top : top + side_px, left : left + side_px]
    how = cv2.INTER_AREA if side_px > size_px else cv2.INTER_LINEAR
    return cv2.resize(square, (size_px, size_px), interpolation=how)


def size_of_picture(path: Path) -> tuple[int, int]:
    """Return height and width of a picture file; InputError as for read_picture."""
    height_px, width_px = _decoded(path).shape
    return height_px, width_px


def _decoded(path: Path) -> np.ndarray:
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: expected a readable picture, got {error.strerror}") from error
    grey = None
    if content and not _is_cut_off(content):
        grey = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_GRAYSCALE)
    if grey is None:
        raise InputError(f"{path}: expected a picture, got a broken file of {len(content)} bytes")
    return grey


def _pictures_in(directory: Path, least: int) -> list[Path]:
    """Return the picture files of a directory by name; hidden files and notes are no pictures."""
    if not directory.is_dir():
        raise InputError(f"stimuli.directory: expected both train and test, got no {directory}")
    pictures = []
    for path in sorted(directory.iterdir()):
        suffix = path.suffix.lower()
        if path.name.startswith(".") or not path.is_file() or suffix in _NOTES:
            continue
        if suffix not in SUFFIXES:
            raise InputError(f"{path}: expected a picture ({', '.join(SUFFIXES)}), got {path.name}")
        pictures.append(path)
    if len(pictures) < least:
        raise InputError(
            f"{directory}: expected {least} or more pictures ({', '.join(SUFFIXES)}), "
            f"got {len(pictures)}"
        )
    return pictures


def _shuffled(paths: list[Path], seed: int, role: str) -> tuple[Path, ...]:
    order = generator(seed, f"stimulus directory {role}", 0).permutation(len(paths))
    return tuple(paths[i] for i in order)


def _is_cut_off(content: bytes) -> bool:
    """Whether a JPEG or PNG file lacks its end, which decoders fill with grey and say nothing."""
    if content.startswith(b"\xff\xd8"):
        return not _has_end_of_jpeg(content)
    if content.startswith(b"\x89PNG"):
        return b"IEND" not in content
    return False


def _has_end_of_jpeg(content: bytes) -> bool:
    """Whether a JPEG's segments lead to its end-of-image marker (ITU-T T.81, annex B).

    Thumbnails lie inside segments, and what a camera has appended lies behind the marker.
    """
    at = 2
    while 0 <= (at := content.find(b"\xff", at)) < len(content) - 1:
        marker = content[at + 1]
        if marker == 0xD9:
            return True
        if marker == 0xFF:  # fill byte
            at += 1
        elif marker in (0x00, 0x01) or 0xD0 <= marker <= 0xD8:  # without a length; 00: coded data
            at += 2
        else:
            at += 2 + int.from_bytes(content[at + 2 : at + 4], "big")
    return False
