"""What the benchmark found: derived numbers, bounds, and the table."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from experiment_manager.measures.tables import number, text_table

CRITICAL_STAGES = ("physics", "rendering", "encoding", "actor_critic")
_HOPS_BETWEEN_LEARNERS = 2  # coder to actor-critic, actor-critic to plant


@dataclass(frozen=True)
class Bound:
    """What a number must be: at least (sign 1) or at most (sign -1) the limit."""

    limit: float
    sign: int

    def holds(self, value: float) -> bool:
        """Return whether value is within the bound."""
        return self.sign * (value - self.limit) >= 0.0

    def __str__(self) -> str:
        """Return the bound as a table shows it."""
        return f"{'>=' if self.sign > 0 else '<='} {self.limit:g}"


BOUNDS = {
    "graph_iterations_per_s": Bound(245.0, 1),
    "graph_roi_iterations_per_s": Bound(260.0, 1),
    "graph_plane_iterations_per_s": Bound(310.0, 1),
    "graph_roi_plane_iterations_per_s": Bound(370.0, 1),
    "in_process_roi_plane_iterations_per_s": Bound(450.0, 1),
    "in_process_pair_at_once_iterations_per_s": Bound(900.0, 1),
    "in_process_twelve_iterations_per_s": Bound(500.0, 1),
    "in_process_twelve_m_c_iterations_per_s": Bound(500.0, 1),
    "graph_to_in_process": Bound(0.8, 1),
    "encode_pair_ms": Bound(0.6, -1),
    "encode_to_numpy": Bound(0.5, -1),
    "flatness": Bound(0.95, 1),
    "peak_memory_total_mb": Bound(4096.0, -1),
    "peak_memory_plane_total_mb": Bound(1536.0, -1),
    "start_to_first_iteration_s": Bound(15.0, -1),
    "start_to_first_iteration_plane_s": Bound(6.0, -1),
    # With more, the rates say as much of the machine as of the graph.
    "cores_busy_elsewhere": Bound(0.1, -1),
}
# Of stages in one process, one core, with the ray caster and a region of interest.
STAGE_BOUNDS_MS = {
    "physics": Bound(0.25, -1),
    "episode_start": Bound(1.0, -1),
    "dictionary_step": Bound(0.5, -1),
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
    rows = [(name, _text(results[name]), *_judged(name, results[name])) for name in _SCALARS]
    period_ms = 1e3 / results["graph_iterations_per_s"]
    path = [
        (name, number(value), f"{100.0 * value / period_ms:.0f} %")
        for name, value in results["critical_path_ms"].items()
    ]
    stages = [(name, number(value)) for name, value in results["stages_ms"].items()]
    plane_stages = [
        (name, number(value), *_against_bound(STAGE_BOUNDS_MS.get(name), value))
        for name, value in results["roi_plane_stages_ms"].items()
    ]
    memory = results["peak_memory_mb"]
    work = results["cpu_ms_per_iteration"]
    processes = [
        (name, number(work.get(name)), f"{memory.get(name, 0.0):.0f}") for name in sorted(memory)
    ]
    ratios = [
        (name, number(value), number(results["against"][name]))
        for name, value in results.get("against_ratios", {}).items()
    ]
    against = (text_table(("ratio to the other commit", "ours / theirs", "theirs"), ratios),)
    return "\n\n".join(
        (
            text_table(("what", "value", "bound", ""), rows),
            text_table(("critical path of the graph", "ms", "share"), path),
            text_table(("stage, in process", "ms"), stages),
            text_table(("stage, region of interest, plane", "ms", "bound", ""), plane_stages),
            text_table(("process", "CPU ms/iteration", "peak MB"), processes),
            *(against if ratios else ()),
        )
    )


_SCALARS = (
    "graph_iterations_per_s",
    "graph_roi_iterations_per_s",
    "graph_plane_iterations_per_s",
    "graph_roi_plane_iterations_per_s",
    "in_process_iterations_per_s",
    "in_process_roi_plane_iterations_per_s",
    "in_process_pair_at_once_iterations_per_s",
    "in_process_twelve_iterations_per_s",
    "in_process_twelve_m_c_iterations_per_s",
    "graph_to_in_process",
    "encode_pair_ms",
    "encode_numpy_ms",
    "encode_sklearn_omp_ms",
    "encode_to_numpy",
    "flatness",
    "flatness_of_work",
    "peak_memory_total_mb",
    "peak_memory_plane_total_mb",
    "start_to_first_iteration_s",
    "start_to_first_iteration_plane_s",
    "cores_busy_elsewhere",
)


def _text(value: float | None) -> str:
    return "-" if value is None else f"{value:.4g}"


def _judged(name: str, value: float | None) -> tuple[str, str]:
    return _against_bound(BOUNDS.get(name), value)


def _against_bound(bound: Bound | None, value: float | None) -> tuple[str, str]:
    if bound is None or value is None:
        return "", ""
    return str(bound), "ok" if bound.holds(value) else "MISSED"
