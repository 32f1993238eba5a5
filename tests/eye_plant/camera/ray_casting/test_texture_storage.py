"""Pictures with their levels in plain memory, or in a file beside the picture."""

import hashlib
from pathlib import Path

import numpy as np
import pytest

from eye_plant.camera.mipmaps import mipmap_levels, reduced
from eye_plant.camera.ray_casting.texture_storage import Texture, texture_of, textures_of
from eye_plant.stimuli.cache import write_array

SHAPES = [(37, 50), (64, 64), (1, 9), (1, 1)]


def picture_of(shape: tuple[int, ...]) -> np.ndarray:
    return np.random.default_rng(1).integers(0, 256, shape, dtype=np.uint8)


def mapped(path: Path) -> np.ndarray:
    return write_array(path, picture_of((37, 50)))


def levels_in(texture: Texture) -> list[np.ndarray]:
    largest, texels, levels = texture
    found = []
    for i, (offset, height_px, width_px) in enumerate(levels):
        array = texels if i else largest
        found.append(array[offset : offset + height_px * width_px].reshape(height_px, width_px))
    return found


def assert_same(actual: Texture, expected: list[np.ndarray]) -> None:
    for level, expected_level in zip(levels_in(actual), expected, strict=True):
        np.testing.assert_array_equal(level, expected_level)


@pytest.mark.parametrize("shape", SHAPES)
def test_all_levels_are_found_where_the_table_says(shape: tuple[int, ...]) -> None:
    picture = picture_of(shape)
    assert_same(texture_of(picture), mipmap_levels(picture))
    ((full, smaller),) = textures_of([picture])
    assert_same(full, mipmap_levels(picture))
    assert_same(smaller, mipmap_levels(reduced(picture)))


def test_a_mapped_picture_has_its_copies_beside_it(tmp_path: Path) -> None:
    picture = mapped(tmp_path / "a.npy")
    ((_, first),) = textures_of([picture])
    (file,) = tmp_path.glob("a.*.levels")
    made = file.stat()
    ((full, second),) = textures_of([picture])
    assert (file.stat().st_ino, file.stat().st_mtime_ns) == (made.st_ino, made.st_mtime_ns)
    assert_same(full, mipmap_levels(np.asarray(picture)))
    assert_same(second, levels_in(first))


def test_version_1_of_the_files_holds_these_bytes(tmp_path: Path) -> None:
    """Where this fails, give texture_storage._VERSION the next number, and this test its bytes."""
    textures_of([mapped(tmp_path / "a.npy")])
    copies = np.load(tmp_path / "a.v1.levels")
    assert hashlib.sha256(copies.tobytes()).hexdigest()[:16] == "6a6e25ad67387707"


@pytest.mark.parametrize("content", [b"", b"no array", b"\x93NUMPY"])
def test_a_damaged_file_of_copies_is_made_again(tmp_path: Path, content: bytes) -> None:
    picture = mapped(tmp_path / "a.npy")
    textures_of([picture])
    (file,) = tmp_path.glob("a.*.levels")
    file.write_bytes(content)
    ((_, smaller),) = textures_of([picture])
    assert_same(smaller, mipmap_levels(reduced(np.asarray(picture))))
    assert file.stat().st_size > 1000


def test_copies_that_cannot_be_kept_stay_in_memory(tmp_path, monkeypatch) -> None:
    picture = mapped(tmp_path / "a.npy")

    def refuse(*_: object) -> None:
        raise OSError

    monkeypatch.setattr("eye_plant.camera.ray_casting.texture_storage.write_array", refuse)
    ((_, smaller),) = textures_of([picture])
    assert_same(smaller, mipmap_levels(reduced(np.asarray(picture))))
    assert [path.name for path in tmp_path.iterdir()] == ["a.npy"]


def test_textures_cannot_be_written_to() -> None:
    ((full, smaller),) = textures_of([picture_of((8, 8))])
    assert not any(a.flags.writeable for a in (*full, *smaller))


@pytest.mark.usefixtures("ctrl_c_amid_locks")
def test_ctrl_c_while_levels_are_made(tmp_path: Path) -> None:
    picture = mapped(tmp_path / "picture.npy")
    with pytest.raises(KeyboardInterrupt):
        textures_of([picture] * 500)
