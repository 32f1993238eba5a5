"""Mistyped options."""

import pytest

from lockstep.written.command_line import CommandLine


def error_of(words: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    line = CommandLine(prog="program")
    line.add_argument("--model")
    line.add_argument("--iterations", type=int)
    with pytest.raises(SystemExit) as stopped:
        line.parse_args(words)
    assert stopped.value.code == 2
    return capsys.readouterr().err


@pytest.mark.parametrize("words", [["--modle", "M"], ["--modle=M"]])
def test_the_nearest_option_is_told(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert error_of(words, capsys).endswith("; did you mean --model?\n")


@pytest.mark.parametrize("words", [["--zzzzzz"], ["word"]])
def test_what_is_like_none(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert "did you mean" not in error_of(words, capsys)


def test_options_are_not_abbreviated(capsys: pytest.CaptureFixture[str]) -> None:
    assert "--mod" in error_of(["--mod", "M"], capsys)


def test_a_working_directory_that_was_deleted(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    tmp_path.rmdir()
    assert error_of([], capsys).startswith("program: error: expected a working directory that ex")
