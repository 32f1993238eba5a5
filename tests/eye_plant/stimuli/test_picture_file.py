"""Picture files of the user's: what becomes of good ones, and what is said of bad ones."""

import os
import struct
import zlib
from collections.abc import Callable
from functools import partial
from pathlib import Path

import cv2
import numpy as np
import pytest

from eye_plant.stimuli.picture_file import read_each, read_picture
from lockstep import InputError

SIZE_PX = 96
read = partial(read_picture, size_px=SIZE_PX, smallest_px=64)


def noise(n_levels: int = 256, kind: type = np.uint8) -> np.ndarray:
    return np.random.default_rng(0).integers(0, n_levels, (400, 500)).astype(kind)


def write(path: Path, picture: np.ndarray) -> Path:
    cv2.imwrite(str(path), picture)
    return path


def test_a_picture_is_cropped_square_about_its_centre_and_resized(tmp_path: Path) -> None:
    wide = np.zeros((100, 300, 3), np.uint8)
    wide[:, 100:150] = (255, 255, 255)  # the central square's left half
    picture = read(write(tmp_path / "a.png", wide))
    assert picture.shape == (SIZE_PX, SIZE_PX)
    assert (picture[:, : SIZE_PX // 2 - 1] == 255).all()
    assert (picture[:, SIZE_PX // 2 + 1 :] == 0).all()


def test_colour_becomes_grey(tmp_path: Path) -> None:
    green = np.zeros((80, 80, 3), np.uint8)
    green[:40, :, 1] = 200
    # ITU-R BT.601: 0.587 * 200
    assert read(write(tmp_path / "a.png", green))[0, 0] == 117


def test_sixteen_bits_become_eight(tmp_path: Path) -> None:
    picture = np.zeros((96, 96), np.uint16)
    picture[:48] = 200 * 256
    assert read(write(tmp_path / "a.png", picture))[0, 0] == 200


def test_what_a_camera_appends_to_a_picture_does_not_break_it(tmp_path: Path) -> None:
    photo = write(tmp_path / "a.jpg", noise())
    photo.write_bytes(photo.read_bytes() + b"a film\xff\xda\x12\x34")
    read(photo)


def test_bytes_too_many_in_the_head_of_a_jpeg_do_not_break_it(tmp_path: Path) -> None:
    photo = write(tmp_path / "a.jpg", noise())
    content = photo.read_bytes()
    table = content.index(b"\xff\xdb")
    photo.write_bytes(content[:table] + bytes(11) + content[table:])
    read(photo)


def _cut_off(content: bytes) -> bytes:
    return content[:-5000]


def _garbage(content: bytes) -> bytes:
    return b"these are no pixels"


def _nothing(content: bytes) -> bytes:
    return b""


@pytest.mark.parametrize("breaks", [_cut_off, _garbage, _nothing])
@pytest.mark.parametrize("suffix", [".jpg", ".png", ".tif", ".bmp", ".webp"])
def test_a_broken_file_is_named(
    tmp_path: Path, suffix: str, breaks: Callable[[bytes], bytes], capfd
) -> None:
    path = write(tmp_path / f"a{suffix}", noise())
    path.write_bytes(breaks(path.read_bytes()))
    with pytest.raises(InputError, match=rf"{path}: expected an image, got a "):
        read(path)
    assert capfd.readouterr().err == "", "the decoders' own words"


def _with_zeros(content: bytes) -> bytes:
    half = len(content) // 2
    return content[:half] + bytes(50) + content[half + 50 :]


def _with_a_gap(content: bytes) -> bytes:
    half = len(content) // 2
    return content[:half] + content[half + 500 :]


@pytest.mark.parametrize("breaks", [_with_zeros, _with_a_gap])
@pytest.mark.parametrize("suffix", [".jpg", ".png"])
def test_a_file_that_is_damaged_inside_is_named(tmp_path, suffix, breaks) -> None:
    path = write(tmp_path / f"a{suffix}", noise())
    path.write_bytes(breaks(path.read_bytes()))
    expected = "file that is damaged inside: Corrupt JPEG data" if suffix == ".jpg" else "broken"
    with pytest.raises(InputError, match=rf"{path}: expected an image, got a {expected}"):
        read(path)


@pytest.mark.parametrize("compression", [5, 32773])  # LZW and PackBits, as TIFF numbers them
def test_a_compressed_tiff_that_is_damaged_inside_is_named(tmp_path, compression: int) -> None:
    path = tmp_path / "a.tif"
    smooth = cv2.resize(noise()[:40, :50], (500, 400))
    cv2.imwrite(str(path), smooth, [cv2.IMWRITE_TIFF_COMPRESSION, compression])
    path.write_bytes(_with_zeros(path.read_bytes()))
    with pytest.raises(InputError, match=r"damaged inside: (LZW|PackBits)Decode: "):
        read(path)


@pytest.mark.parametrize("kind", [np.float32, np.float64, np.int32])
def test_more_than_sixteen_bits_are_named(tmp_path: Path, kind: type) -> None:
    path = write(tmp_path / "a.tiff", noise(kind=kind))
    with pytest.raises(InputError, match=rf"got one of {kind.__name__} \(expected 8 or 16 bits\)"):
        read(path)


def test_a_picture_beyond_what_opencv_reads_is_named(tmp_path: Path) -> None:
    def chunk(kind: bytes, data: bytes) -> bytes:
        return (
            struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        )

    path = tmp_path / "a.png"
    head = struct.pack(">IIBBBBB", 40_000, 40_000, 1, 0, 0, 0, 0)
    parts = chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(b"")) + chunk(b"IEND", b"")
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + parts)
    with pytest.raises(InputError, match=rf"{path}: expected an image of 2\^30 pixels at most"):
        read(path)


@pytest.mark.parametrize(
    ("picture", "greys"),
    [
        (noise(4096, np.uint16), "0 to 15"),  # of 12 bits
        (noise(10), "0 to 9"),
        (255 - noise(10), "246 to 255"),
        (np.full((96, 96), 90, np.uint8), "90 to 90"),
    ],
)
def test_a_picture_without_contrast_is_named(tmp_path: Path, picture, greys: str) -> None:
    path = write(tmp_path / "a.png", picture[:96, :96])
    with pytest.raises(InputError, match=rf"{path}: expected .* contrast, got greys from {greys} "):
        read(path)


def test_all_faults_are_one_error(tmp_path: Path) -> None:
    paths = [write(tmp_path / f"{i:02d}.png", noise(1 if i % 2 else 256)) for i in range(40)]
    paths[0].write_bytes(b"x")
    with pytest.raises(InputError, match=r"^21 of 40 images cannot be used: ") as error:
        read_each(read, paths)
    assert all(str(path) in str(error.value) for path in (paths[0], *paths[1::2]))
    assert str(paths[2]) not in str(error.value)


def test_without_a_standard_error_pictures_are_read(tmp_path: Path) -> None:
    path = write(tmp_path / "a.png", noise())
    kept = os.dup(2)
    os.close(2)
    try:
        read(path)
    finally:
        os.dup2(kept, 2)
        os.close(kept)
