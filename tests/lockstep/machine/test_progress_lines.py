"""A log gets lines, a terminal a bar."""

import io

import pytest

from lockstep.machine import progress_lines
from lockstep.machine.progress_lines import progress


class _Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_a_log_gets_whole_lines(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(progress_lines, "LINE_PERIOD_S", 0.0)
    log = io.StringIO()
    assert list(progress(range(3), file=log, desc="test", unit="trial")) == [0, 1, 2]
    text = log.getvalue()
    assert "\r" not in text
    lines = text.splitlines()
    assert len(lines) == 3
    assert lines[0].startswith("test: 1 of 3 trial, 33 %, ")


def test_between_two_lines_are_ten_seconds() -> None:
    log = io.StringIO()
    bar = progress(file=log, total=1000, unit="it")
    for _ in range(999):
        bar.update(1)
    assert log.getvalue() == ""
    bar.close()
    (line,) = log.getvalue().splitlines()
    assert line.startswith("999 of 1000 it, 100 %, ")


def test_other_text_stands_on_its_own_line() -> None:
    log = io.StringIO()
    bar = progress(file=log, total=2, unit="it")
    bar.write("a test", file=log)
    assert log.getvalue() == "a test\n"


def test_a_terminal_gets_a_bar() -> None:
    terminal = _Terminal()
    assert list(progress(range(3), file=terminal, unit="trial")) == [0, 1, 2]
    assert "\r" in terminal.getvalue()
