"""Two commits' benchmarks, compared number by number."""

from pathlib import Path

import pytest

from tests.benchmark.against import medians, numbers_of, ratios, worktree


def test_numbers_are_named_by_their_place() -> None:
    results = {"rate": 2, "stages": {"physics": 0.5}, "flat": None, "runs": [1.0]}
    assert numbers_of(results) == {"rate": 2.0, "stages.physics": 0.5}


def test_ratios_are_medians_of_the_turns_ratios() -> None:
    ours = [{"rate": 2.0, "new": 1.0, "idle": 1.0}, {"rate": 9.0}, {"rate": 4.0}]
    theirs = [{"rate": 1.0, "idle": 0.0}, {"rate": 3.0}, {"rate": 4.0}]
    assert ratios(ours, theirs) == {"rate": 2.0}
    assert medians(theirs) == {"rate": 3.0}


def test_an_unknown_revision_is_named(tmp_path: Path) -> None:
    with (
        pytest.raises(RuntimeError, match="no-such-revision"),
        worktree("no-such-revision", tmp_path),
    ):
        pass
    assert not (tmp_path / "worktree").exists()
