"""Writes a film of a bag: .mp4 (VP9, which browsers play) or .gif."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path

import cv2
import numpy as np
from PIL import Image

from active_binocular_vision.film.frames import Frame, frames
from active_binocular_vision.film.scenes import scenes
from experiment_manager import Bag
from lockstep import InputError

_ITERATIONS_PER_S = 5
_NS_PER_S = 1e9
# As many as a GIF may have: with fewer, red and cyan of an anaglyph become orange and blue.
_GIF_COLOURS = 256

Frames = Iterable[Frame]


def film(path: Path, file: Path, rate: float | None = None) -> float:
    """Write the film of a bag; return its duration in seconds.

    rate: simulated seconds per second; None for five iterations per second. Raises InputError for
    another ending than .mp4 or .gif, a file that is there, and a bag without pictures; OSError when
    the file cannot be written. Nothing half-written is left.
    """
    write = _WRITERS.get(file.suffix)
    if write is None:
        raise InputError(f"--film: expected a file that ends in .mp4 or .gif, got {file}")
    if file.exists():
        raise InputError(f"--film: expected a new file, {file} exists")
    bag = Bag(path)
    shown = scenes(bag)
    iterations_per_s = rate / _period_s(bag) if rate is not None else _ITERATIONS_PER_S
    unfinished = file.with_name(f".unfinished-{file.name}")
    try:
        n_periods = write(unfinished, frames(shown), iterations_per_s)
        unfinished.rename(file)
    finally:
        unfinished.unlink(missing_ok=True)
    return n_periods / iterations_per_s


def _period_s(bag: Bag) -> float:
    """Return the simulated time between two iterations."""
    return float(np.diff(bag.vectors("ground_truth")["ground_truth"].stamps_ns).min()) / _NS_PER_S


def _write_mp4(file: Path, shown: Frames, frames_per_s: float) -> int:
    writer, n_frames = None, 0
    for picture, n_periods in shown:
        if writer is None:
            height_px, width_px = picture.shape[:2]
            code = cv2.VideoWriter.fourcc(*"vp09")
            writer = cv2.VideoWriter(str(file), code, frames_per_s, (width_px, height_px))
            if not writer.isOpened():
                raise OSError(f"{file}: cannot be written as a VP9 film")
        for _ in range(n_periods):
            writer.write(cv2.cvtColor(picture, cv2.COLOR_RGB2BGR))
        n_frames += n_periods
    if writer is not None:
        writer.release()
    # OpenCV raises nothing where the disk is full.
    n_written = int(cv2.VideoCapture(str(file)).get(cv2.CAP_PROP_FRAME_COUNT))
    if n_written != n_frames:
        raise OSError(
            f"{file}: expected a film of {n_frames} frames, got {max(n_written, 0)}; the disk may "
            "be full"
        )
    return n_frames


def _write_gif(file: Path, shown: Frames, frames_per_s: float) -> int:
    with file.open("wb") as stream:  # before minutes of drawing
        pictures, periods = zip(*((Image.fromarray(p), n) for p, n in shown), strict=True)
        palette = _common_palette(pictures)
        first, *rest = (p.quantize(palette=palette, dither=Image.Dither.NONE) for p in pictures)
        ms = [round(n_periods * 1000 / frames_per_s) for n_periods in periods]
        first.save(stream, "GIF", save_all=True, append_images=rest, duration=ms, loop=0)
    return sum(periods)


def _common_palette(pictures: Sequence[Image.Image]) -> Image.Image:
    """Return one palette for all pictures, so that what does not change need not be stored."""
    some = pictures[:: max(1, len(pictures) // 8)]
    strip = Image.fromarray(np.vstack([np.asarray(picture) for picture in some]))
    # Median cut spends its colours on greys that hardly differ: larger files with larger errors.
    return strip.quantize(_GIF_COLOURS, method=Image.Quantize.MAXCOVERAGE)


_Writer = Callable[[Path, Frames, float], int]
_WRITERS: Mapping[str, _Writer] = {".mp4": _write_mp4, ".gif": _write_gif}
