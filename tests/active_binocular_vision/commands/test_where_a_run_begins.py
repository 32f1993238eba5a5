"""What a run says of its source, and where it begins."""

import subprocess
from pathlib import Path

import pytest

from active_binocular_vision.commands import run
from active_binocular_vision.commands.run import prepare_new, source_commit
from experiment_manager import RunRequest
from experiment_manager.run.config_file import CONFIG_FILE
from lockstep import InputError
from tests.patience import PATIENCE_S


def _git(folder: Path, *words: str) -> str:
    named = ("-c", "user.name=Anybody", "-c", "user.email=anybody@example.org")
    command = ["git", "-C", str(folder), *named, *words]
    return subprocess.run(
        command, check=True, capture_output=True, text=True, timeout=PATIENCE_S
    ).stdout.strip()


def test_the_commit_is_that_of_the_source_in_any_environment(monkeypatch, tmp_path) -> None:
    _git(tmp_path, "init")
    _git(tmp_path, "commit", "--allow-empty", "--message", "theirs")
    commit = source_commit()
    monkeypatch.setenv("GIT_DIR", str(tmp_path / ".git"))  # as in a hook
    monkeypatch.setenv("GIT_WORK_TREE", str(tmp_path))
    assert source_commit() == commit != _git(tmp_path, "rev-parse", "HEAD")
    copy = tmp_path / "unpacked" / "run.py"
    copy.parent.mkdir()
    copy.touch()
    monkeypatch.setattr(run, "__file__", str(copy))
    assert source_commit() == "unknown"  # the repository around a copy is somebody else's


def test_of_two_runs_that_begin_at_once_one_has_the_directory(monkeypatch, tmp_path) -> None:
    directory = tmp_path / "20261127-120000"

    def somebody_else_begins(configuration: object) -> None:
        directory.mkdir()
        (directory / CONFIG_FILE).write_text("theirs")

    monkeypatch.setattr(run, "_prepare_stimuli", somebody_else_begins)
    with pytest.raises(InputError, match="expected a new or empty directory"):
        prepare_new(RunRequest(), directory)
    assert [path.read_text() for path in directory.iterdir()] == ["theirs"]
