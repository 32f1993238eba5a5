"""Derived numbers and the table of the benchmark."""

from typing import Any

import pytest

from tests.benchmark.report import BOUNDS, critical_path_ms, report

STAGES_MS = {
    "physics": 0.5,
    "rendering": 1.5,
    "encoding": 0.4,
    "dictionary_step": 0.9,
    "actor_critic": 0.2,
}


def _results(**changes: float | None) -> dict[str, Any]:
    scalars: dict[str, Any] = {
        "graph_iterations_per_s": 250.0,
        "graph_roi_iterations_per_s": 330.0,
        "graph_plane_iterations_per_s": 330.0,
        "graph_roi_plane_iterations_per_s": 390.0,
        "in_process_iterations_per_s": 260.0,
        "in_process_roi_plane_iterations_per_s": 460.0,
        "in_process_pair_at_once_iterations_per_s": 950.0,
        "in_process_twelve_iterations_per_s": 510.0,
        "in_process_twelve_m_c_iterations_per_s": 520.0,
        "graph_to_in_process": 0.96,
        "encode_pair_ms": 0.4,
        "encode_numpy_ms": 1.6,
        "encode_sklearn_omp_ms": None,
        "encode_to_numpy": 0.25,
        "flatness": 0.99,
        "flatness_of_work": 1.0,
        "peak_memory_total_mb": 2000.0,
        "peak_memory_plane_total_mb": 1000.0,
        "start_to_first_iteration_s": 9.0,
        "start_to_first_iteration_plane_s": 5.0,
        "cores_busy_elsewhere": 0.02,
        "stages_ms": STAGES_MS,
        "roi_plane_stages_ms": STAGES_MS,
        "critical_path_ms": {"physics": 1.0, "rest": 3.0},
        "peak_memory_mb": {"eye_plant": 1500.0, "supervisor": 500.0},
        "cpu_ms_per_iteration": {"eye_plant": 4.25},
    }
    return scalars | changes


def test_the_critical_path_adds_up_to_the_period() -> None:
    path_ms = critical_path_ms(STAGES_MS, {"vector": 0.2, "pictures": 0.3}, 4.0)
    assert path_ms["message_hops"] == pytest.approx(0.7)
    assert "dictionary_step" not in path_ms
    assert path_ms["rest"] == pytest.approx(4.0 - 0.5 - 1.5 - 0.4 - 0.2 - 0.7)


@pytest.mark.parametrize("name", sorted(BOUNDS))
def test_a_bound_is_met_at_its_limit_and_missed_beyond(name: str) -> None:
    bound = BOUNDS[name]
    assert bound.holds(bound.limit)
    assert not bound.holds(bound.limit - 0.01 * bound.sign)


def test_the_report_says_what_is_missed() -> None:
    lines = report(_results(graph_roi_iterations_per_s=120.0)).splitlines()
    (graph,) = (line.split() for line in lines if line.startswith("graph_iterations_per_s"))
    (roi,) = (line.split() for line in lines if line.startswith("graph_roi_iterations_per_s"))
    assert graph[1:] == ["250", ">=", "245", "ok"]
    assert roi[1:] == ["120", ">=", "260", "MISSED"]


def test_the_report_shows_shares_and_what_was_not_measured() -> None:
    lines = [line.split() for line in report(_results()).splitlines()]
    assert ["rest", "3.000", "75", "%"] in lines
    assert ["encode_sklearn_omp_ms", "-"] in lines
    assert ["eye_plant", "4.250", "1500"] in lines
    assert ["supervisor", "-", "500"] in lines
    assert ["physics", "0.500", "<=", "0.25", "MISSED"] in lines


def test_the_report_ends_with_the_ratios_to_another_commit() -> None:
    against: dict[str, Any] = {"against": {"graph_iterations_per_s": 200.0}}
    against["against_ratios"] = {"graph_iterations_per_s": 1.25}
    lines = report(_results() | against).splitlines()
    assert lines[-1].split() == ["graph_iterations_per_s", "1.250", "200.000"]
