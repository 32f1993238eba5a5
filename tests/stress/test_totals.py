"""Slices of the torture add up, whenever it is broken off, and no problem of one is lost."""

from dataclasses import replace
from pathlib import Path
from unittest import mock

import pytest

from tests.stress import __main__ as torture
from tests.stress.totals import Totals


def test_a_slice_that_could_not_go_on_counts_nothing_and_ends_its_part(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    give_up = mock.Mock(side_effect=TimeoutError("waited in vain"))
    monkeypatch.setitem(torture.PARTS, "kills", replace(torture.PARTS["kills"], work=give_up))
    path = tmp_path / "totals.json"
    line = "--kills 25 --inputs 0 --soak 0 --start-kills 0 --memory-limits 0 --totals"
    assert torture.main([*line.split(), str(path)]) == 1
    found = Totals(path, 1).of("kills")
    assert (found.n_done, found.problems) == (0, ["TimeoutError: waited in vain"])


def test_slices_add_up_over_several_starts(tmp_path: Path) -> None:
    path = tmp_path / "totals.json"
    first = {
        "runs": 2,
        "by_kind": {"plant killed": 3},
        "longest_s": 45.0,
        "peak_mb": {"plant": 150.0, "coder": 20.0},
    }
    Totals(path, 1).add("kills", 10, first, [])
    second = {
        "runs": 1,
        "by_kind": {"plant killed": 1, "plant stopped": 2},
        "longest_s": 2.0,
        "peak_mb": {"plant": 140.0, "coder": 30.0},
    }
    Totals(path, 1).add("kills", 5, second, ["one differed"])
    found = Totals(path, 1).of("kills")
    assert (found.n_slices, found.n_done, found.problems) == (2, 15, ["one differed"])
    assert found.figures == {
        "runs": 3,
        "by_kind": {"plant killed": 4, "plant stopped": 2},
        "longest_s": 45.0,
        "peak_mb": {"plant": 150.0, "coder": 30.0},
    }
    assert Totals(path, 1).of("cuts").n_done == 0
