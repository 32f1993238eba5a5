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
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from experiment_manager.launch.command_line import arguments
from experiment_manager.launch.configuration import configuration_of
from tests.benchmark.encoding import encoding_times_ms
from tests.benchmark.graph import supervised_run
from tests.benchmark.loop import STAGES, LoopWindow, TimedLoop
from tests.benchmark.messages import hop_times_ms, recording_ms
from tests.benchmark.report import critical_path_ms, report
from tests.benchmark.samples import (
    Sample,
    cores_elsewhere,
    cpu_ms_per_iteration,
    flatness,
    rate_hz,
)

# Longer than any benchmark, so that all of it is training; a test comes only at the end.
_ENDLESS = 1_000_000
_ROI = ["--set", "eye_plant.camera.roi_width_px=128", "--set", "eye_plant.camera.roi_height_px=128"]
_WARM_UP_ITERATIONS = 300


@dataclass(frozen=True)
class Plan:
    """How long to measure: rounds of turns, and long runs, if any, for the flatness."""

    n_rounds: int
    turn_s: float
    n_long_runs: int
    n_flatness_iterations: int
    n_encodings: int
    n_round_trips: int


FULL = Plan(
    n_rounds=7,
    turn_s=5.0,
    n_long_runs=3,
    n_flatness_iterations=20_000,
    n_encodings=400,
    n_round_trips=2000,
)
QUICK = Plan(
    n_rounds=2,
    turn_s=4.0,
    n_long_runs=0,
    n_flatness_iterations=0,
    n_encodings=100,
    n_round_trips=500,
)


@dataclass(frozen=True)
class Round:
    """One turn of each party.

    starts_s: of the two graphs, to the first iteration; peak_memory_mb: of the first one, by
    process.
    """

    graph: list[Sample]
    roi: list[Sample]
    loop: LoopWindow
    starts_s: tuple[float, float]
    peak_memory_mb: dict[str, float]


def _arguments(more: Sequence[str]) -> list[str]:
    return [
        *("--profile", "paper", "--iterations", str(_ENDLESS), "--tests", str(_ENDLESS)),
        *more,
    ]


def measure(plan: Plan, directory: Path) -> dict[str, Any]:
    """Return all results of one benchmark, as benchmark.sh writes them to JSON.

    directory: for the runs, empty. Raises RuntimeError when a graph does not get going.
    """
    results = _measure_long_runs(plan, directory)
    loop = TimedLoop(configuration_of(arguments(_arguments([])), "benchmark"))
    try:
        loop.window(plan.turn_s / 2.0)
        rounds = [_round(plan, loop, directory / f"round_{i}") for i in range(plan.n_rounds)]
        peaks_mb = [r.peak_memory_mb for r in rounds]
        if plan.n_long_runs:
            peaks_mb.append(results["peak_memory_mb"])
        highest_mb = _highest(peaks_mb)
        results |= _summary(rounds) | {
            "peak_memory_mb": highest_mb,
            "peak_memory_total_mb": sum(highest_mb.values()),
        }
        _say("encoding, messages, recording")
        encoding_ms = encoding_times_ms(loop.coder, loop.pictures, plan.n_encodings)
    finally:
        loop.close()
    hops_ms = hop_times_ms(plan.n_round_trips)
    stages_ms = {name: _median([r.loop.stages_ms[name] for r in rounds]) for name in STAGES} | {
        "message_hop": hops_ms["vector"],
        "pictures_hop": hops_ms["pictures"],
        "recording": recording_ms(directory / "round_0" / "graph" / "bag", directory / "copy"),
    }
    ours_ms, numpy_ms = encoding_ms["ours"], encoding_ms["numpy"]
    assert ours_ms is not None
    assert numpy_ms is not None
    return results | {
        "encode_pair_ms": ours_ms,
        "encode_numpy_ms": numpy_ms,
        "encode_sklearn_omp_ms": encoding_ms["sklearn"],
        "encode_to_numpy": ours_ms / numpy_ms,
        "stages_ms": stages_ms,
        "critical_path_ms": critical_path_ms(
            stages_ms, hops_ms, 1e3 / results["graph_iterations_per_s"]
        ),
    }


def _measure_long_runs(plan: Plan, directory: Path) -> dict[str, Any]:
    """Return what long runs show: their memory, and their flatness; the rate of one run wavers."""
    if not plan.n_long_runs:
        return {"flatness": None, "flatness_of_work": None, "flatness_of_runs": []}
    runs = [
        _long_run(plan.n_flatness_iterations, directory / f"long_{i}")
        for i in range(plan.n_long_runs)
    ]
    rates, works = zip(*(flatness(samples) for samples, _ in runs), strict=True)
    return {
        "flatness": _median(rates),
        "flatness_of_work": _median(works),
        "flatness_of_runs": list(rates),
        "peak_memory_mb": _highest([peak_mb for _, peak_mb in runs]),
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


def _highest(peaks_mb: Sequence[dict[str, float]]) -> dict[str, float]:
    return {name: max(peak_mb[name] for peak_mb in peaks_mb) for name in peaks_mb[0]}


def _round(plan: Plan, loop: TimedLoop, directory: Path) -> Round:
    """Return one round: the graph, the graph with a region of interest, the loop."""
    _say(f"{directory.name}: graph, graph with region of interest, one process")
    directory.mkdir()
    turns, starts_s, peaks_mb = [], [], []
    for name, more in (("graph", []), ("roi", _ROI)):
        with supervised_run(_arguments(more), directory / name) as graph:
            starts_s.append(graph.await_start(_WARM_UP_ITERATIONS))
            turns.append(graph.window(plan.turn_s))
            peaks_mb.append(dict(graph.peak_memory_mb))
    starts = (starts_s[0], starts_s[1])
    return Round(turns[0], turns[1], loop.window(plan.turn_s), starts, peaks_mb[0])


def _summary(rounds: Sequence[Round]) -> dict[str, Any]:
    graph_hz = [rate_hz(r.graph) for r in rounds]
    works = [cpu_ms_per_iteration(r.graph) for r in rounds]
    return {
        "start_to_first_iteration_s": _median([s for r in rounds for s in r.starts_s]),
        "graph_iterations_per_s": _median(graph_hz),
        "graph_roi_iterations_per_s": _median([rate_hz(r.roi) for r in rounds]),
        "in_process_iterations_per_s": _median([r.loop.rate_hz for r in rounds]),
        "graph_to_in_process": _median(
            [hz / r.loop.rate_hz for hz, r in zip(graph_hz, rounds, strict=True)]
        ),
        "cores_busy_elsewhere": _median([cores_elsewhere(r.graph) for r in rounds]),
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
    parser.add_argument("--quick", action="store_true", help="less than two minutes, less exact")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write all numbers there")
    options = parser.parse_args(argv)
    with tempfile.TemporaryDirectory(prefix="benchmark-") as directory:
        try:
            results = measure(QUICK if options.quick else FULL, Path(directory))
        except RuntimeError as error:
            print(f"error: {error}", file=sys.stderr)
            return 1
    results |= {"n_cores": os.cpu_count(), "load_average": os.getloadavg()[0]}
    print(report(results))
    if options.json is not None:
        options.json.write_text(json.dumps(results, indent=2) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
