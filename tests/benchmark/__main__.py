"""benchmark.sh: how fast the graph is, how fast the same loop in one process, and where time goes.

Ratios are medians over rounds in which the parties take turns, so that they hold on a machine that
has other work to do.
"""

import argparse
import json
import os
import sys
import tempfile
from collections.abc import Sequence
from contextlib import ExitStack, closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from tests.benchmark.against import results_in_turns
from tests.benchmark.encoding import encoding_times_ms
from tests.benchmark.graph import supervised_run
from tests.benchmark.loop import STAGES, LoopWindow, TimedLoop
from tests.benchmark.messages import hop_times_ms, recording_ms
from tests.benchmark.report import critical_path_ms, report
from tests.benchmark.samples import Sample, cores_elsewhere, cpu_ms_per_iteration, flatness, rate_hz
from tests.command_lines import configured

# Longer than any benchmark, so that all of it is training; a test comes only at the end.
_ENDLESS = 1_000_000
_ROI = ["--set", "eyes.camera.roi_width_px=128", "--set", "eyes.camera.roi_height_px=128"]
_PLANE = ["--set", "eyes.camera.renderer=plane"]
_GRAPHS: dict[str, list[str]] = {
    "graph": [],
    "graph_roi": _ROI,
    "graph_plane": _PLANE,
    "graph_roi_plane": _ROI + _PLANE,
}
# In one process; all but the first on one core.
_LOOPS: dict[str, list[str]] = {
    "in_process": [],
    "in_process_roi_plane": _ROI + _PLANE,
    "in_process_pair_at_once": [*_ROI, *_PLANE, "--set", "eyes.mechanics.moves=at_once"],
    "in_process_twelve": ["--profile", "twelve", *_ROI, *_PLANE],
    "in_process_twelve_m_c": ["--profile", "twelve_m_c", *_ROI, *_PLANE],
}
_WARM_UP_ITERATIONS = 300


@dataclass(frozen=True)
class Plan:
    """How long to measure: rounds of turns, and long runs, if any, for the flatness.

    n_turns: with another commit's benchmark, if one is asked for.
    """

    n_rounds: int
    turn_s: float
    n_long_runs: int
    n_flatness_iterations: int
    n_encodings: int
    n_round_trips: int
    n_turns: int


FULL = Plan(
    n_rounds=7,
    turn_s=5.0,
    n_long_runs=3,
    n_flatness_iterations=20_000,
    n_encodings=400,
    n_round_trips=2000,
    n_turns=3,
)
QUICK = Plan(
    n_rounds=2,
    turn_s=4.0,
    n_long_runs=0,
    n_flatness_iterations=0,
    n_encodings=100,
    n_round_trips=500,
    n_turns=1,
)


@dataclass(frozen=True)
class GraphTurn:
    """One graph: its samples, seconds to its first iteration, peak memory of each process."""

    samples: list[Sample]
    start_s: float
    peak_memory_mb: dict[str, float]


@dataclass(frozen=True)
class Round:
    """One turn of each party.

    By name, see _GRAPHS and _LOOPS.
    """

    graphs: dict[str, GraphTurn]
    loops: dict[str, LoopWindow]


def _arguments(more: Sequence[str]) -> list[str]:
    return [*("--profile", "paper", "--iterations", str(_ENDLESS), "--tests", str(_ENDLESS)), *more]


def measure(plan: Plan, directory: Path) -> dict[str, Any]:
    """Return all results of one benchmark, as benchmark.sh writes them to JSON.

    directory: for the runs, empty. Raises an error with its reason when a graph does not start.
    """
    results = _measure_long_runs(plan, directory)
    with ExitStack() as stack:
        loops = {
            name: stack.enter_context(closing(TimedLoop(configured(*_arguments(more)))))
            for name, more in _LOOPS.items()
        }
        for loop in loops.values():
            loop.window(plan.turn_s / 2.0)
        rounds = [_round(plan, loops, directory / f"round_{i}") for i in range(plan.n_rounds)]
        _say("encoding, messages, recording")
        loop = loops["in_process"]
        encoding_ms = encoding_times_ms(loop.coder, loop.pictures, plan.n_encodings)
    long_peaks_mb = results.pop("peaks_mb")
    results |= _summary(rounds)
    results |= _memory("", [*(r.graphs["graph"].peak_memory_mb for r in rounds), *long_peaks_mb])
    results |= _memory("_plane", [r.graphs["graph_plane"].peak_memory_mb for r in rounds])
    hops_ms = hop_times_ms(plan.n_round_trips)
    stages_ms = _stages_ms(rounds, "in_process") | {
        "message_hop": hops_ms["vector"],
        "pictures_hop": hops_ms["pictures"],
        "recording": recording_ms(directory / "round_0" / "graph" / "bag", directory / "copy"),
    }
    return results | {
        "encode_pair_ms": encoding_ms["ours"],
        "encode_numpy_ms": encoding_ms["numpy"],
        "encode_sklearn_omp_ms": encoding_ms.get("sklearn"),
        "encode_to_numpy": encoding_ms["ours"] / encoding_ms["numpy"],
        "stages_ms": stages_ms,
        "roi_plane_stages_ms": _stages_ms(rounds, "in_process_roi_plane"),
        "critical_path_ms": critical_path_ms(
            stages_ms, hops_ms, 1e3 / results["graph_iterations_per_s"]
        ),
    }


def _stages_ms(rounds: Sequence[Round], loop: str) -> dict[str, float]:
    return {name: _median([r.loops[loop].stages_ms[name] for r in rounds]) for name in STAGES}


def _measure_long_runs(plan: Plan, directory: Path) -> dict[str, Any]:
    """Return the flatness of long runs, and "peaks_mb" of each; the rate of one run wavers."""
    if not plan.n_long_runs:
        return {"flatness": None, "flatness_of_work": None, "flatness_of_runs": [], "peaks_mb": []}
    runs = [
        _long_run(plan.n_flatness_iterations, directory / f"long_{i}")
        for i in range(plan.n_long_runs)
    ]
    rates, works = zip(*(flatness(samples) for samples, _ in runs), strict=True)
    return {
        "flatness": _median(rates),
        "flatness_of_work": _median(works),
        "flatness_of_runs": list(rates),
        "peaks_mb": [peak_mb for _, peak_mb in runs],
    }


def _long_run(n_iterations: int, directory: Path) -> tuple[list[Sample], dict[str, float]]:
    """Return the samples of one long run, and the peak memory of each process, MB."""
    _say(f"{directory.name}: {n_iterations} iterations")
    with supervised_run(_arguments([]), directory) as graph:
        graph.await_start(_WARM_UP_ITERATIONS)
        i_first = len(graph.samples) - 1
        last = graph.samples[i_first].n_iterations + n_iterations
        graph.listen_until(lambda: graph.samples[-1].n_iterations >= last)
        return graph.samples[i_first:], dict(graph.peak_memory_mb)


def _memory(renderer: str, peaks_mb: Sequence[dict[str, float]]) -> dict[str, Any]:
    """Return the highest of several peaks of each process, and their sum."""
    highest_mb = {name: max(peak_mb[name] for peak_mb in peaks_mb) for name in peaks_mb[0]}
    return {
        f"peak_memory{renderer}_mb": highest_mb,
        f"peak_memory{renderer}_total_mb": sum(highest_mb.values()),
    }


def _round(plan: Plan, loops: dict[str, TimedLoop], directory: Path) -> Round:
    """Return one round: the graphs, then the loops in this process."""
    _say(f"{directory.name}: {', '.join([*_GRAPHS, *_LOOPS])}")
    directory.mkdir()
    graphs = {name: _turn(plan, more, directory / name) for name, more in _GRAPHS.items()}
    cores = os.sched_getaffinity(0)
    windows = {}
    try:
        for name, loop in loops.items():
            windows[name] = loop.window(plan.turn_s)
            os.sched_setaffinity(0, {min(cores)})
    finally:
        os.sched_setaffinity(0, cores)
    return Round(graphs, windows)


def _turn(plan: Plan, more: Sequence[str], directory: Path) -> GraphTurn:
    with supervised_run(_arguments(more), directory) as graph:
        start_s = graph.await_start(_WARM_UP_ITERATIONS)
        return GraphTurn(graph.window(plan.turn_s), start_s, dict(graph.peak_memory_mb))


def _summary(rounds: Sequence[Round]) -> dict[str, Any]:
    graph_hz = [rate_hz(r.graphs["graph"].samples) for r in rounds]
    works = [cpu_ms_per_iteration(r.graphs["graph"].samples) for r in rounds]
    rates = {
        f"{name}_iterations_per_s": _median([rate_hz(r.graphs[name].samples) for r in rounds])
        for name in _GRAPHS
    } | {
        f"{name}_iterations_per_s": _median([r.loops[name].rate_hz for r in rounds])
        for name in _LOOPS
    }
    starts_s = {
        renderer: _median([r.graphs[name].start_s for r in rounds for name in names])
        for renderer, names in (
            ("", ("graph", "graph_roi")),
            ("_plane", ("graph_plane", "graph_roi_plane")),
        )
    }
    return rates | {
        "start_to_first_iteration_s": starts_s[""],
        "start_to_first_iteration_plane_s": starts_s["_plane"],
        "graph_to_in_process": _median(
            [hz / r.loops["in_process"].rate_hz for hz, r in zip(graph_hz, rounds, strict=True)]
        ),
        "cores_busy_elsewhere": _median(
            [cores_elsewhere(r.graphs["graph"].samples) for r in rounds]
        ),
        "cpu_ms_per_iteration": {
            name: _median([work[name] for work in works]) for name in works[0]
        },
    }


def _median(values: Sequence[float]) -> float:
    return float(np.median(values))


def _say(text: str) -> None:
    print(f"measuring {text}", file=sys.stderr, flush=True)


def main(argv: Sequence[str] | None = None) -> int:
    """Measure, print the table, and write JSON if asked; return the exit code."""
    parser = argparse.ArgumentParser(
        prog="benchmark.sh", description="Measure the speed of the graph and of its stages."
    )
    parser.add_argument(
        "--quick", action="store_true", help="take a few minutes, with less exact numbers"
    )
    parser.add_argument(
        "--against",
        metavar="REV",
        help="then run the quick benchmarks of this commit and of REV in turns, with their ratios",
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all numbers to FILE")
    options = parser.parse_args(argv)
    with tempfile.TemporaryDirectory(prefix="benchmark-") as directory:
        try:
            plan = QUICK if options.quick else FULL
            results = measure(plan, Path(directory))
            if options.against is not None:
                results |= results_in_turns(options.against, plan.n_turns, Path(directory))
        except (AssertionError, RuntimeError, TimeoutError) as error:
            print(f"error: {error}", file=sys.stderr)
            return 1
    results |= {"n_cores": os.cpu_count(), "load_average": os.getloadavg()[0]}
    print(report(results))
    if options.json is not None:
        options.json.write_text(json.dumps(results, indent=2) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
