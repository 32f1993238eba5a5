"""What the benchmark found: derived numbers, bounds, and the table."""

from collections.abc import Mapping
from typing import Any

from experiment_manager.measures.tables import number, text_table

CRITICAL_STAGES = ("physics", "rendering", "encoding", "actor_critic")
_HOPS_BETWEEN_LEARNERS = 2  # coder to actor-critic, actor-critic to plant


AT_LEAST = {
    "graph_iterations_per_s": 245.0,
    "graph_roi_iterations_per_s": 260.0,
    "graph_plane_iterations_per_s": 310.0,
    "graph_roi_plane_iterations_per_s": 370.0,
    "in_process_roi_plane_iterations_per_s": 450.0,
    "in_process_pair_at_once_iterations_per_s": 900.0,
    "in_process_twelve_iterations_per_s": 500.0,
    "in_process_twelve_m_c_iterations_per_s": 500.0,
    "graph_to_in_process": 0.8,
    "flatness": 0.95,
}
AT_MOST = {
    "encode_pair_ms": 0.6,
    "encode_to_numpy": 0.5,
    "peak_memory_total_mb": 4096.0,
    "peak_memory_plane_total_mb": 1536.0,
    "start_to_first_iteration_s": 15.0,
    "start_to_first_iteration_plane_s": 6.0,
    # With more, the rates say as much of the machine as of the graph.
    "cores_busy_elsewhere": 0.1,
    # Stages in one process, one core, with the ray caster and a region of interest; ms.
    "physics": 0.25,
    "episode_start": 1.0,
    "dictionary_step": 0.5,
}


def critical_path_ms(
    stages_ms: Mapping[str, float], hops_ms: Mapping[str, float], period_ms: float
) -> dict[str, float]:
    """Return what the time between two iterations of the graph is made of, by name.

    The stages as the in-process loop takes them; the pictures' hop and two of vectors; and the
    rest: what the stages gain or lose with the other nodes at work beside them.
    """
    path = {name: stages_ms[name] for name in CRITICAL_STAGES}
    path["message_hops"] = hops_ms["pictures"] + _HOPS_BETWEEN_LEARNERS * hops_ms["vector"]
    path["rest"] = period_ms - sum(path.values())
    return path


def report(results: Mapping[str, Any]) -> str:
    """Return the tables of a benchmark's JSON document."""
    rows = [
        (name, "-" if value is None else f"{value:.4g}", *_judged(name, value))
        for name, value in results.items()
        if not isinstance(value, Mapping | list)
    ]
    period_ms = 1e3 / results["graph_iterations_per_s"]
    path = [
        (name, number(value), f"{100.0 * value / period_ms:.0f} %")
        for name, value in results["critical_path_ms"].items()
    ]
    stages = [(name, number(value)) for name, value in results["stages_ms"].items()]
    plane_stages = [
        (name, number(value), *_judged(name, value))
        for name, value in results["roi_plane_stages_ms"].items()
    ]
    work = results["cpu_ms_per_iteration"]
    processes = [
        (name, number(work.get(name)), f"{peak_mb:.0f}")
        for name, peak_mb in sorted(results["peak_memory_mb"].items())
    ]
    tables = [
        text_table(("what", "value", "bound", ""), rows),
        text_table(("critical path of the graph", "ms", "share"), path),
        text_table(("stage, in process", "ms"), stages),
        text_table(("stage, region of interest, plane", "ms", "bound", ""), plane_stages),
        text_table(("process", "CPU ms/iteration", "peak MB"), processes),
    ]
    if "against_ratios" in results:
        ratios = [
            (name, number(value), number(results["against"][name]))
            for name, value in results["against_ratios"].items()
        ]
        tables.append(text_table(("ratio to the other commit", "ours / theirs", "theirs"), ratios))
    return "\n\n".join(tables)


def _judged(name: str, value: float | None) -> tuple[str, str]:
    """Return the bound of a number and whether it is met, in words, if it has one."""
    if value is None or name not in AT_LEAST | AT_MOST:
        return "", ""
    if name in AT_LEAST:
        return f">= {AT_LEAST[name]:g}", "ok" if value >= AT_LEAST[name] else "MISSED"
    return f"<= {AT_MOST[name]:g}", "ok" if value <= AT_MOST[name] else "MISSED"
