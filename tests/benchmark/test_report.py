"""Derived numbers and the table of the benchmark."""

from typing import Any

import pytest

from tests.benchmark.report import critical_path_ms, report

STAGES_MS = {
    "physics": 0.5,
    "rendering": 1.5,
    "encoding": 0.4,
    "dictionary_step": 0.9,
    "actor_critic": 0.2,
}


def _results(**changes: float | None) -> dict[str, Any]:
    return {
        "graph_iterations_per_s": 250.0,
        "encode_sklearn_omp_ms": None,
        "flatness": None,
        "flatness_of_runs": [],
        "start_to_first_iteration_s": 15.0,
        "stages_ms": STAGES_MS,
        "roi_plane_stages_ms": STAGES_MS,
        "critical_path_ms": {"physics": 1.0, "rest": 3.0},
        "peak_memory_mb": {"eye_plant": 1500.0, "supervisor": 500.0},
        "cpu_ms_per_iteration": {"eye_plant": 4.25},
        **changes,
    }


def test_the_critical_path_adds_up_to_the_period() -> None:
    path_ms = critical_path_ms(STAGES_MS, {"vector": 0.2, "pictures": 0.3}, 4.0)
    assert path_ms["message_hops"] == pytest.approx(0.7)
    assert "dictionary_step" not in path_ms
    assert path_ms["rest"] == pytest.approx(4.0 - 0.5 - 1.5 - 0.4 - 0.2 - 0.7)


def test_the_report_says_what_is_missed() -> None:
    results = _results(graph_roi_iterations_per_s=259.0, graph_to_in_process=0.8, encode_pair_ms=1)
    rows = {words[0]: words[1:] for line in report(results).splitlines() if (words := line.split())}
    assert rows["graph_iterations_per_s"] == ["250", ">=", "245", "ok"]
    assert rows["graph_roi_iterations_per_s"] == ["259", ">=", "260", "MISSED"]
    assert rows["graph_to_in_process"] == ["0.8", ">=", "0.8", "ok"]
    assert rows["start_to_first_iteration_s"] == ["15", "<=", "15", "ok"]
    assert rows["encode_pair_ms"] == ["1", "<=", "0.6", "MISSED"]


def test_the_report_shows_shares_and_what_was_not_measured() -> None:
    lines = [line.split() for line in report(_results()).splitlines()]
    assert ["rest", "3.000", "75", "%"] in lines
    assert ["encode_sklearn_omp_ms", "-"] in lines
    assert ["flatness", "-"] in lines
    assert ["physics", "0.500"] in lines
    assert ["eye_plant", "4.250", "1500"] in lines
    assert ["supervisor", "-", "500"] in lines
    assert ["physics", "0.500", "<=", "0.25", "MISSED"] in lines


def test_the_report_ends_with_the_ratios_to_another_commit() -> None:
    against: dict[str, Any] = {"against": {"graph_iterations_per_s": 200.0}}
    against["against_ratios"] = {"graph_iterations_per_s": 1.25}
    lines = report(_results() | against).splitlines()
    assert lines[-1].split() == ["graph_iterations_per_s", "1.250", "200.000"]
