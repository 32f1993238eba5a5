"""The benchmark's arithmetic, turns and table."""

from pathlib import Path

import pytest

from tools.benchmark.against import compared, rates_in_turns, worker, worktree
from tools.benchmark.graph import rate_hz
from tools.benchmark.measuring import report


def test_a_rate_lies_between_the_first_and_the_last_sample() -> None:
    assert rate_hz([(10.0, 100), (11.0, 350), (14.0, 900)]) == pytest.approx(200.0)


def test_windows_are_taken_in_turns_and_the_other_begins_each_second_time() -> None:
    calls: list[str] = []

    def window(name: str, duration_s: float) -> float:
        calls.append(name)
        return duration_s * (2.0 if name == "ours" else 1.0)

    rates = rates_in_turns(lambda s: window("ours", s), lambda s: window("theirs", s), 3, 5.0)
    assert rates == ([10.0] * 3, [5.0] * 3)
    assert calls == ["ours", "theirs", "theirs", "ours", "ours", "theirs"]


def test_ratios_are_of_each_turn() -> None:
    found = compared([2.0, 9.0, 4.0], [1.0, 3.0, 4.0])
    assert [
        found[f"ratio{quartile}"] for quartile in ("", "_lower_quartile", "_upper_quartile")
    ] == ([2.0, 1.5, 2.5])
    assert (found["ours_iterations_per_s"], found["theirs_iterations_per_s"]) == (4.0, 3.0)


def test_an_unknown_revision_is_named(tmp_path: Path) -> None:
    with (
        pytest.raises(RuntimeError, match="no-such-revision"),
        worktree("no-such-revision", tmp_path),
    ):
        pass
    assert not (tmp_path / "worktree").exists()


def test_a_worker_that_cannot_begin_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "src").mkdir()
    with (
        pytest.raises(RuntimeError, match=f"{tmp_path} ended with exit code 1"),
        worker(tmp_path, "in_process"),
    ):
        pass


def test_the_report_says_what_is_missed() -> None:
    results = {
        "graph_iterations_per_s": 250.0,
        "graph_to_in_process": 0.7,
        "encode_pair_ms": 0.5,
        "stages_ms": {"physics": 0.25},
    }
    rows = {words[0]: words[1:] for line in report(results).splitlines() if (words := line.split())}
    assert rows["graph_iterations_per_s"] == ["250", ">=", "240", "ok"]
    assert rows["graph_to_in_process"] == ["0.7", ">=", "0.8", "MISSED"]
    assert rows["encode_pair_ms"] == ["0.5", "<=", "0.6", "ok"]
    assert rows["stages_ms.physics"] == ["0.25"]
