"""Locks on files, also where there are none."""

import errno
from pathlib import Path

import pytest

from lockstep.files import locks
from tests.refusing import refusing


def test_one_of_two_gets_a_lock_and_all_share_one(tmp_path: Path) -> None:
    path = tmp_path / "a"
    with path.open("w") as one, path.open() as other:
        assert locks.takes_lock(one)
        assert not locks.takes_lock(other, shared=True)
    with path.open() as one, path.open() as other:
        assert locks.takes_lock(one, shared=True)
        assert locks.takes_lock(other, shared=True)


@pytest.mark.parametrize("number", [errno.ENOSYS, errno.ENOLCK, errno.EOPNOTSUPP, errno.EPERM])
def test_without_locks_all_get_them_and_one_warning(tmp_path, monkeypatch, capsys, number) -> None:
    monkeypatch.setattr(locks.fcntl, "flock", refusing(number))
    for name in ("a", "b"):
        with (tmp_path / name).open("w") as file:
            assert locks.takes_lock(file)
    said = capsys.readouterr().err
    assert said.count("warning: ") == 1
    assert f"warning: {tmp_path}: no locks on this file system (flock: " in said


def test_a_file_system_that_fails_gives_no_lock(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(locks.fcntl, "flock", refusing(errno.EIO))
    with (tmp_path / "a").open("w") as file, pytest.raises(OSError, match=f"Errno {errno.EIO}"):
        locks.takes_lock(file)
