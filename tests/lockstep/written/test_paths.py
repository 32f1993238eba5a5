"""Paths as people write them."""

from pathlib import Path

import pytest

from lockstep import InputError
from lockstep.written.paths import written_path


@pytest.mark.parametrize(
    ("text", "path"),
    [
        ("~", "/home/me"),
        ("~/runs/x", "/home/me/runs/x"),
        ("$HOME/photos", "/home/me/photos"),
        ("${HOME}/photos", "/home/me/photos"),
        ("$HOMES/photos", "$HOMES/photos"),
        ("runs/~", "runs/~"),
        ("~nobody-has-this-name/x", "~nobody-has-this-name/x"),
        ("/data/$HOME #1: ", "/data/$HOME #1: "),
    ],
)
def test_the_home_directory_at_the_start(monkeypatch, text: str, path: str) -> None:
    monkeypatch.setenv("HOME", "/home/me")
    assert written_path(text) == Path(path)


def test_no_path_is_not_the_working_directory() -> None:
    with pytest.raises(InputError, match="expected a path, got ''"):
        written_path("")
