"""Output that nobody takes any more, and files that cannot be written."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from experiment_manager.run.lasting_output import lasting
from lockstep import durable_files
from lockstep.durable_files import replace_file, why_unwritable


def test_a_reader_that_leaves_is_not_missed() -> None:
    theirs, ours = os.pipe()
    stream = lasting(os.fdopen(ours, "w"))
    print("hello", file=stream, flush=True)
    assert os.read(theirs, 10) == b"hello\n"
    os.close(theirs)
    for _ in range(3):
        print("is anybody there", file=stream, flush=True)
    assert not stream.isatty()
    stream.close()


def test_streams_that_were_closed_from_the_start_go_nowhere() -> None:
    code = (
        "import sys;"
        "from experiment_manager.run.lasting_output import ignore_broken_pipes;"
        "ignore_broken_pipes(); print('lost'); print('lost', file=sys.stderr, flush=True);"
        "sys.exit(sys.stderr.fileno() + 40)"
    )
    done = subprocess.run(
        ["sh", "-c", 'exec "$0" -c "$1" <&- >&- 2>&-', sys.executable, code], check=False
    )
    assert done.returncode == 42


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
