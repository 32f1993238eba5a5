"""Two commits' benchmarks, compared number by number."""

from pathlib import Path

import pytest

from tests.benchmark.against import ROOT, benchmark_module, medians, numbers_of, ratios, worktree


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


def test_the_benchmark_is_the_module_that_its_script_starts(tmp_path: Path) -> None:
    assert benchmark_module(ROOT) == "tests.benchmark"
    (tmp_path / "launch_scripts").mkdir()
    script = tmp_path / "launch_scripts" / "benchmark.sh"
    script.write_text('set -e\nrun_module elsewhere.benchmark "$@"\n')
    assert benchmark_module(tmp_path) == "elsewhere.benchmark"
    script.write_text("exit\n")
    with pytest.raises(RuntimeError, match=r"benchmark\.sh: expected a line run_module MODULE"):
        benchmark_module(tmp_path)
