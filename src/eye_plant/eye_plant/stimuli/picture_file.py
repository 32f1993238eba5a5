"""A picture file of the user's: what becomes of it, or why it can be no stimulus."""

import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeVar

import cv2
import numpy as np

from lockstep import InputError
from lockstep.machine.library_messages import library_messages

Item = TypeVar("Item")
Result = TypeVar("Result")

# ours: greys between the darkest and the brightest hundredth of a picture, out of 256. Data of 12
# bits in a file of 16, which are nearly black, have 15 at most.
_LEAST_CONTRAST, _OUTLIERS = 16, 0.01
# What decoders say of data that they then replace by grey. Bytes too many before the markers of a
# JPEG's head are none of the picture's.
_DAMAGE = re.compile(
    r"Corrupt JPEG data: (?!\d+ extraneous bytes before marker 0x(?:c[012]|db|e.|fe)).*"
    r"|Premature end of .*|Inconsistent progression .*|Invalid SOS .*|(?<=TIFF_Error ).*"
    r"|(?<=TIFF_Warning )\w+Decode: .*"
)
# A list of faults is as long as it is: each has to be mended.
_MOST_CHARACTERS = 100_000


def read_each(read: Callable[[Item], Result], items: Sequence[Item]) -> list[Result]:
    """Return what `read` makes of each file; raises one InputError with the faults of all.

    items: paths, or what `read` takes instead, such as a pair of paths.
    """
    results, faults = [], []
    for item in items:
        try:
            results.append(read(item))
        except InputError as error:
            faults.append(str(error))
    if len(faults) > 1:
        faults = [f"{len(faults)} of {len(items)} images cannot be used: {'; '.join(faults)}"]
    if faults:
        raise InputError(faults[0], longest=_MOST_CHARACTERS)
    return results


def read_picture(path: Path, size_px: int, smallest_px: int) -> np.ndarray:
    """Return the central square of a picture file, grey, (size_px, size_px) uint8.

    Reduced by area averaging, enlarged bilinearly. Raises InputError naming a file that cannot be
    decoded, or only with damage, whose shorter side is below smallest_px, or whose square has
    hardly any contrast.
    """
    grey = _decoded(path)
    height_px, width_px = grey.shape
    side_px = min(height_px, width_px)
    if side_px < smallest_px:
        raise InputError(
            f"{path}: expected an image of {smallest_px} x {smallest_px} px or more, "
            f"got {width_px} x {height_px}"
        )
    top, left = (height_px - side_px) // 2, (width_px - side_px) // 2
    square = grey[top : top + side_px, left : left + side_px]
    how = cv2.INTER_AREA if side_px > size_px else cv2.INTER_LINEAR
    stimulus = cv2.resize(square, (size_px, size_px), interpolation=how)
    share_up_to = np.cumsum(np.bincount(stimulus.ravel(), minlength=256)) / stimulus.size
    darkest, brightest = np.searchsorted(share_up_to, (_OUTLIERS, 1.0 - _OUTLIERS))
    if brightest - darkest < _LEAST_CONTRAST:
        raise InputError(
            f"{path}: expected an image with contrast, got greys from {darkest} to {brightest} of "
            "0 to 255"
        )
    return stimulus


def size_of_picture(path: Path) -> tuple[int, int]:
    """Return height and width of a picture file; InputError as for read_picture."""
    height_px, width_px = _decoded(path).shape
    return height_px, width_px


def _decoded(path: Path) -> np.ndarray:
    """Return a file's picture, (height, width) uint8."""
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: expected a readable image, got {error.strerror}") from error
    got = f"a broken file of {len(content)} bytes"
    if content and not _is_cut_off(content):
        data = np.frombuffer(content, np.uint8)
        try:
            with library_messages() as messages:
                grey = cv2.imdecode(data, cv2.IMREAD_GRAYSCALE)
                other = grey if grey is not None else cv2.imdecode(data, cv2.IMREAD_UNCHANGED)
        except cv2.error as error:
            raise InputError(
                f"{path}: expected an image of 2^30 pixels at most, got {error.err}"
            ) from error
        damage = _DAMAGE.search(messages())
        if damage is not None:
            got = f"a file that is damaged inside: {damage[0]}"
        elif grey is not None:
            return grey
        elif other is not None:
            got = f"one of {other.dtype.name} (expected 8 or 16 bits)"
    raise InputError(f"{path}: expected an image, got {got}")


def _is_cut_off(content: bytes) -> bool:
    """Whether a JPEG lacks its end, which OpenCV 4 fills with grey and says nothing."""
    return content.startswith(b"\xff\xd8") and not _has_end_of_jpeg(content)


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
