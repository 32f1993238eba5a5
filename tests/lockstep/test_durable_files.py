"""Files that cannot be written."""

from pathlib import Path

import pytest

from lockstep import durable_files
from lockstep.durable_files import replace_file, why_unwritable


def test_a_file_that_cannot_be_replaced_leaves_nothing(tmp_path, monkeypatch) -> None:
    replace_file(tmp_path / "a", b"old")

    def refuse(number: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(durable_files.os, "fsync", refuse)
    with pytest.raises(OSError, match="No space left"):
        replace_file(tmp_path / "a", b"new")
    assert [(path.name, path.read_bytes()) for path in tmp_path.iterdir()] == [("a", b"old")]
    assert why_unwritable(tmp_path) == "[Errno 28] No space left on device"


def test_why_a_directory_cannot_be_written(tmp_path: Path) -> None:
    assert why_unwritable(tmp_path) == ""
    assert not list(tmp_path.iterdir())
    assert "No such file or directory" in why_unwritable(tmp_path / "nowhere")
