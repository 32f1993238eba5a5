"""Files that cannot be written."""

import errno
import os
import stat
from pathlib import Path

import pytest

from lockstep.files import durable_files
from lockstep.files.durable_files import (
    first_to_make,
    replace_file,
    replacement_of,
    why_unwritable,
)
from tests.refusing import refusing


def test_a_file_that_cannot_be_replaced_leaves_nothing(tmp_path, monkeypatch) -> None:
    replace_file(tmp_path / "a", b"old")

    monkeypatch.setattr(durable_files.os, "fsync", refusing(errno.ENOSPC))
    with pytest.raises(OSError, match="No space left"):
        replace_file(tmp_path / "a", b"new")
    assert [(path.name, path.read_bytes()) for path in tmp_path.iterdir()] == [("a", b"old")]
    assert why_unwritable(tmp_path) == "[Errno 28] No space left on device"


def test_one_of_two_makes_a_file(tmp_path: Path) -> None:
    path = tmp_path / "a"
    with first_to_make(path):
        with pytest.raises(FileExistsError), first_to_make(path):
            pass
        replace_file(path, b"first")
    for _ in range(2):
        with pytest.raises(FileExistsError), first_to_make(path):
            pass
    assert [(path.name, path.read_bytes()) for path in tmp_path.iterdir()] == [("a", b"first")]


def test_why_a_directory_cannot_be_written(tmp_path: Path) -> None:
    assert why_unwritable(tmp_path) == ""
    assert not list(tmp_path.iterdir())
    assert "No such file or directory" in why_unwritable(tmp_path / "nowhere")


@pytest.mark.parametrize("number", [errno.EINVAL, errno.ENOSYS, errno.EOPNOTSUPP, errno.EBADF])
@pytest.mark.parametrize("is_kind", [stat.S_ISDIR, stat.S_ISREG])
def test_a_file_system_without_fsync_has_files_all_the_same(
    tmp_path, monkeypatch, is_kind, number
) -> None:
    sync = os.fsync

    def fsync(handle: int) -> None:
        (refusing(number) if is_kind(os.fstat(handle).st_mode) else sync)(handle)

    monkeypatch.setattr(durable_files.os, "fsync", fsync)
    replace_file(tmp_path / "a", b"new")
    assert (tmp_path / "a").read_bytes() == b"new"
    assert why_unwritable(tmp_path) == ""


@pytest.mark.parametrize("number", [errno.EACCES, errno.EPERM, errno.EOPNOTSUPP, errno.EISDIR])
def test_a_directory_that_cannot_be_opened_has_files_all_the_same(
    tmp_path, monkeypatch, number
) -> None:
    monkeypatch.setattr(durable_files.os, "open", refusing(number))
    replace_file(tmp_path / "a", b"new")
    assert (tmp_path / "a").read_bytes() == b"new"


def test_a_disk_that_fails_is_an_error(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(durable_files.os, "fsync", refusing(errno.EIO))
    with pytest.raises(OSError, match="Input/output error"):
        durable_files.sync_directory(tmp_path)


@pytest.mark.parametrize("number", [errno.EPERM, errno.EBUSY, errno.EXDEV])
def test_a_rename_that_is_refused_leaves_nothing(tmp_path, monkeypatch, number) -> None:
    replace_file(tmp_path / "a", b"old")
    monkeypatch.setattr(Path, "replace", refusing(number))
    with pytest.raises(OSError, match=os.strerror(number)):
        replace_file(tmp_path / "a", b"new")
    assert [(path.name, path.read_bytes()) for path in tmp_path.iterdir()] == [("a", b"old")]


def test_a_block_that_is_interrupted_leaves_nothing(tmp_path: Path) -> None:
    def interrupted() -> None:
        with replacement_of(tmp_path / "a") as file:
            file.write(b"a part")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert not list(tmp_path.iterdir())
