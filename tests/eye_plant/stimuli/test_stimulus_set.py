"""Generated stimuli, their cache, and directories of the user's own pictures."""

import errno
import hashlib
import os
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import IO, Any

import cv2
import numpy as np
import pytest

from eye_plant import StimulusSet, load_stimuli
from eye_plant.camera.ray_casting.texture_storage import textures_of
from eye_plant.stimuli import cache
from eye_plant.stimuli import generator as stimulus_generator
from eye_plant.stimuli.generator import generate_stimulus
from eye_plant.stimuli.stimulus_set import (
    StimuliConfig,
    announcement,
    count_stimuli,
    load_unseen_stimuli,
)
from lockstep import InputError
from lockstep.files import mapped_files
from tests.refusing import refusing

SIZE_PX = 96


def small(cache: Path, **changes: Any) -> StimuliConfig:
    config = StimuliConfig(n_training=4, n_test=2, size_px=SIZE_PX, cache_directory=str(cache))
    return replace(config, **changes)


def of_directory(directory: Path, **changes: Any) -> StimuliConfig:
    return small(Path(), directory=str(directory), **changes)


def write_pictures(directory: Path, n: int, suffix: str = ".png") -> None:
    """Write n pictures, number i of grey 10 + i above and of 200 below."""
    directory.mkdir(parents=True, exist_ok=True)
    for i in range(n):
        picture = np.full((80, 100), 10 + i, np.uint8)
        picture[40:] = 200
        cv2.imwrite(str(directory / f"{i:03d}{suffix}"), picture)


def greys(stimuli: tuple[np.ndarray, ...]) -> list[int]:
    return [int(stimulus[0, 0]) for stimulus in stimuli]


# --- the generator


@pytest.fixture(scope="module")
def pictures() -> list[np.ndarray]:
    return [generate_stimulus(0, "training", number, 1920) for number in range(3)]


def amplitude_slope(picture: np.ndarray, lowest: float, highest: float) -> float:
    """Exponent of the amplitude spectrum between two frequencies in cycles per picture."""
    n = picture.shape[0]
    window = np.outer(np.hanning(n), np.hanning(n))
    power = np.abs(np.fft.rfft2((picture - picture.mean()) * window)) ** 2
    frequency = np.hypot(np.fft.fftfreq(n, 1.0 / n)[:, None], np.arange(power.shape[1])[None])
    band = frequency.astype(int).ravel()
    radial = np.bincount(band, power.ravel()) / np.bincount(band)
    f = np.unique(np.geomspace(lowest, highest, 40).astype(int))
    return 0.5 * float(np.polyfit(np.log(f), np.log(radial[f]), 1)[0])


def test_amplitude_falls_about_as_one_over_frequency(pictures: list[np.ndarray]) -> None:
    # Photographs of natural and man-made scenes lie between about -0.8 and -1.5
    # (Torralba & Oliva 2003, "Statistics of natural image categories").
    slopes = [amplitude_slope(picture, 5.0, 400.0) for picture in pictures]
    assert np.mean(slopes) == pytest.approx(-1.2, abs=0.3)
    assert max(slopes) < -0.8
    assert min(slopes) > -1.6


@pytest.mark.parametrize("size_px", [8, 32, 120, 480])
def test_there_is_contrast_in_every_octave(pictures: list[np.ndarray], size_px: int) -> None:
    for picture in pictures:
        n = 1920 * 4 // size_px
        fine = cv2.resize(picture, (n, n), interpolation=cv2.INTER_AREA).astype(np.float32)
        coarse = cv2.resize(fine, (n // 2, n // 2), interpolation=cv2.INTER_AREA)
        assert (fine - np.kron(coarse, np.ones((2, 2)))).std() > 3.0


def test_every_window_of_the_nearest_plane_has_contrast(pictures: list[np.ndarray]) -> None:
    # At 0.5 m the coarse window spans 160 of the 1920 stimulus pixels.
    for picture in pictures:
        windows = picture.reshape(12, 160, 12, 160)
        assert windows.std(axis=(1, 3)).min() > 5.0


def test_pictures_use_the_grey_scale_without_saturating(pictures: list[np.ndarray]) -> None:
    for picture in pictures:
        assert picture.dtype == np.uint8
        assert 60.0 < picture.mean() < 195.0
        assert picture.std() > 30.0
        assert np.isin(picture, (0, 255)).mean() < 0.15


def test_a_picture_is_a_function_of_seed_role_and_number() -> None:
    first = generate_stimulus(3, "training", 7, SIZE_PX)
    np.testing.assert_array_equal(generate_stimulus(3, "training", 7, SIZE_PX), first)
    for other in ((4, "training", 7), (3, "test", 7), (3, "training", 8)):
        assert (generate_stimulus(*other, SIZE_PX) != first).mean() > 0.5


# --- the cache


def test_pictures_are_all_different_and_counted_training_first(tmp_path: Path) -> None:
    stimuli = load_stimuli(small(tmp_path))
    assert len({stimulus.tobytes() for stimulus in stimuli.all}) == 6
    assert all(stimulus.shape == (SIZE_PX, SIZE_PX) for stimulus in stimuli.all)
    assert (len(stimuli.training), len(stimuli.test)) == count_stimuli(small(tmp_path)) == (4, 2)
    np.testing.assert_array_equal(stimuli.all[4], stimuli.test[0])
    assert len([path for path in tmp_path.rglob("*") if path.is_file()]) == 6


def test_headers_are_parsed_one_after_the_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Threads that parse at once make Python 3.11 fail now and then (CPython issue 106905)."""
    parse, alone = np.lib.format.read_array_header_1_0, []

    def noted(file: IO[bytes]) -> Any:
        alone.append(cache._PARSING.locked())
        return parse(file)

    monkeypatch.setattr(np.lib.format, "read_array_header_1_0", noted)
    for _ in range(2):  # generated, then found
        load_stimuli(small(tmp_path))
    assert alone == [True] * 12


@pytest.mark.parametrize("n_bytes", [0, 6, -1000])
def test_a_damaged_cache_file_is_made_again(tmp_path: Path, n_bytes: int) -> None:
    first = [stimulus.copy() for stimulus in load_stimuli(small(tmp_path)).all]
    path = next(tmp_path.rglob("training_0002.npy"))
    path.write_bytes(path.read_bytes()[:n_bytes])
    np.testing.assert_array_equal(load_stimuli(small(tmp_path)).all, first)


def test_the_second_load_generates_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = load_stimuli(small(tmp_path))

    def refuse(*_: object) -> None:
        raise AssertionError("generated again")

    monkeypatch.setattr(stimulus_generator, "generate_stimulus", refuse)
    assert_same(load_stimuli(small(tmp_path)), first)
    with pytest.raises(AssertionError, match="generated again"):
        load_stimuli(small(tmp_path, seed=1))


def test_more_pictures_extend_the_set(tmp_path: Path) -> None:
    few = load_stimuli(small(tmp_path))
    more = load_stimuli(small(tmp_path, n_training=6))
    assert_same(StimulusSet(more.training[:4], more.test), few)


def test_version_1_of_the_cache_holds_these_bytes(tmp_path: Path) -> None:
    """Where this fails, give stimuli.cache._VERSION the next number, and this test its bytes."""
    load_stimuli(small(tmp_path))
    made = b"".join(np.load(path).tobytes() for path in sorted(tmp_path.glob("v1-*/*.npy")))
    assert hashlib.sha256(made).hexdigest()[:16] == "1e47d0bcbe1db82c"


def test_a_failed_write_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fill_the_disk(file: IO[bytes], array: np.ndarray) -> None:
        file.write(b"a part")
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(np, "save", fill_the_disk)
    with pytest.raises(InputError, match="No space left on device"):
        load_stimuli(small(tmp_path))
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == []


@pytest.mark.usefixtures("ctrl_c_amid_locks")
def test_ctrl_c_amid_the_locks_of_the_pool(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt):
        load_stimuli(small(tmp_path, n_training=500))
    assert len([path for path in tmp_path.rglob("*") if path.is_file()]) < 100


def test_the_user_cache_is_the_default(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    load_stimuli(StimuliConfig(n_training=1, n_test=1, size_px=SIZE_PX))
    assert list((tmp_path / "xdg").rglob("training_0000.npy"))


def test_a_relative_user_cache_is_ignored(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")
    load_stimuli(StimuliConfig(n_training=1, n_test=1, size_px=SIZE_PX))
    assert list((tmp_path / ".cache").rglob("training_0000.npy"))


def test_a_cache_that_cannot_be_written_is_named_with_what_sets_it(tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("")
    with pytest.raises(InputError, match=r"cache_directory: expected a directory.*file") as error:
        load_stimuli(small(blocked))
    assert "XDG_CACHE_HOME=DIR or --set eye_plant.stimuli.cache_directory=DIR" in str(error.value)


def test_a_cache_in_a_home_that_nobody_knows(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("XDG_CACHE_HOME", "HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr("pwd.getpwuid", refusing_key)
    for announce_or_load in (announcement, load_stimuli):
        with pytest.raises(InputError, match=r"to write to, got ~/.cache.*XDG_CACHE_HOME=DIR or"):
            announce_or_load(StimuliConfig(n_training=1, n_test=1, size_px=SIZE_PX))


def refusing_key(uid: int) -> None:
    raise KeyError(uid)


def test_a_cache_of_somebody_else_is_missing_all(tmp_path: Path, monkeypatch) -> None:
    load_stimuli(small(tmp_path))
    monkeypatch.setattr(os, "stat", refusing(errno.EACCES))
    assert announcement(small(tmp_path)).startswith("generating 6 stimuli")


def test_pictures_keep_no_descriptors(tmp_path: Path) -> None:
    # A process may usually have 1,024; with the ray caster's copies two files belong to a picture.
    descriptors = Path("/proc/self/fd")
    before = len([*descriptors.iterdir()])
    pictures = load_stimuli(small(tmp_path)).all
    textures = textures_of(pictures)
    assert len([*descriptors.iterdir()]) == before
    mapped = Path("/proc/self/maps").read_text()
    assert mapped.count(str(tmp_path)) >= len(pictures) + len(textures)
    del pictures, textures
    assert str(tmp_path) not in Path("/proc/self/maps").read_text()


def test_where_nothing_is_mapped_pictures_are_read(tmp_path: Path, monkeypatch) -> None:
    expected = [stimulus.copy() for stimulus in load_stimuli(small(tmp_path)).all]
    monkeypatch.setattr(mapped_files, "_Mapping", refusing(errno.ENODEV))
    found = load_stimuli(small(tmp_path)).all
    np.testing.assert_array_equal(found, expected)
    assert not any(stimulus.flags.writeable for stimulus in found)


def assert_same(actual: StimulusSet, expected: StimulusSet) -> None:
    np.testing.assert_array_equal(actual.training, expected.training)
    np.testing.assert_array_equal(actual.test, expected.test)


# --- a directory


def test_train_and_test_directories_keep_apart(tmp_path: Path) -> None:
    write_pictures(tmp_path / "train", 6)
    write_pictures(tmp_path / "test", 1)
    stimuli = load_stimuli(of_directory(tmp_path))
    assert count_stimuli(of_directory(tmp_path)) == (4, 1)
    assert len(set(greys(stimuli.training))) == 4
    assert greys(stimuli.test) == [10]


def test_one_directory_is_split_by_seed(tmp_path: Path) -> None:
    write_pictures(tmp_path, 20)
    first, again, other = (load_stimuli(of_directory(tmp_path, seed=seed)) for seed in (1, 1, 2))
    assert_same(again, first)
    assert len(set(greys(first.all))) == 6
    assert greys(first.all) != greys(other.all)


def test_a_small_directory_is_split_in_proportion(tmp_path: Path) -> None:
    write_pictures(tmp_path, 7)
    config = of_directory(tmp_path, n_training=100, n_test=40)
    assert count_stimuli(config) == (5, 2)
    assert sorted(greys(load_stimuli(config).all)) == list(range(10, 17))


def test_unseen_stimuli_are_a_whole_directory(tmp_path: Path) -> None:
    write_pictures(tmp_path, 7)
    config = small(Path())
    stimuli = load_unseen_stimuli(str(tmp_path), config, 40)
    assert sorted(greys(stimuli)) == list(range(10, 17))
    assert stimuli[0].shape == (SIZE_PX, SIZE_PX)
    assert greys(load_unseen_stimuli(str(tmp_path), config, 2)) == greys(stimuli)[:2]


def test_unseen_stimuli_of_a_part_for_tests_are_in_the_order_of_a_run(tmp_path: Path) -> None:
    write_pictures(tmp_path / "train", 1)
    write_pictures(tmp_path / "test", 9)
    config = of_directory(tmp_path, n_test=5)
    expected = greys(load_stimuli(config).test)
    assert greys(load_unseen_stimuli(str(tmp_path), config, 5)) == expected
    shutil.rmtree(tmp_path / "train")
    assert greys(load_unseen_stimuli(str(tmp_path), config, 5)) == expected


@pytest.mark.parametrize("part", ["", "test"])
def test_unseen_stimuli_that_are_none(tmp_path: Path, part: str) -> None:
    (tmp_path / part).mkdir(exist_ok=True)
    with pytest.raises(InputError, match="expected 1 or more images"):
        load_unseen_stimuli(str(tmp_path), small(Path()), 40)


def test_hidden_files_and_notes_are_no_pictures(tmp_path: Path) -> None:
    write_pictures(tmp_path, 2, ".JPG")
    (tmp_path / ".hidden").write_text("")
    (tmp_path / "LICENSE.txt").write_text("")
    assert count_stimuli(of_directory(tmp_path)) == (1, 1)


def _small_picture(directory: Path) -> None:
    write_pictures(directory, 2)
    cv2.imwrite(str(directory / "000.png"), np.zeros((63, 500), np.uint8))


def _no_picture(directory: Path) -> None:
    write_pictures(directory, 2)
    (directory / "photo.heic").write_bytes(b"x")


def _links(directory: Path) -> None:
    write_pictures(directory, 2)
    (directory / "a.png").symlink_to("nowhere")
    (directory / "loop").symlink_to("loop")
    (directory / ".hidden.png").symlink_to("nowhere")
    (directory / "b.png").symlink_to("000.png")


def _empty_test(directory: Path) -> None:
    write_pictures(directory / "train", 3)
    (directory / "test").mkdir()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (_small_picture, r"000\.png: expected .* 64 x 64 px or more, got 500 x 63"),
        (_no_picture, r"stimuli: expected images .*, got photo\.heic$"),
        (_links, r"got a\.png \(a link to nowhere that leads nowhere\), loop \(a link to loop "),
        (lambda d: d.rmdir(), r"expected a directory of images, got .*stimuli"),
        (lambda d: None, "expected 2 or more images .* got 0"),
        (lambda d: write_pictures(d, 1), "expected 2 or more images .* got 1"),
        (_empty_test, "test: expected 1 or more images .* got 0"),
        (lambda d: write_pictures(d / "train", 3), "expected both train and test"),
    ],
)
def test_a_directory_that_makes_no_set_is_named(
    tmp_path: Path, make: Callable[[Path], object], message: str
) -> None:
    directory = tmp_path / "stimuli"
    directory.mkdir()
    make(directory)
    with pytest.raises(InputError, match=message):
        load_stimuli(of_directory(directory))


def test_a_directory_that_cannot_be_listed_is_named(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(Path, "iterdir", refusing(errno.EACCES))
    with pytest.raises(InputError, match=rf"{tmp_path}: expected images, got Permission denied"):
        load_stimuli(of_directory(tmp_path))


def test_a_name_beyond_all_limits_is_no_directory() -> None:
    with pytest.raises(InputError, match=r"expected a directory of images, got /n+$"):
        load_stimuli(of_directory(Path(f"/{300 * 'n'}")))


@pytest.mark.parametrize("name", ["n_training", "n_test", "size_px"])
def test_numbers_that_make_no_set_are_refused(name: str) -> None:
    none: dict[str, Any] = {name: 0}
    with pytest.raises(InputError, match=rf"{name}: expected .* got 0"):
        StimuliConfig(**none)
