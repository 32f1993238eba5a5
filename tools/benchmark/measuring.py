"""How fast the graph is, how fast the same loop in one process, and its stages.

Ratios are medians over rounds in which the parties take turns, so that they hold on a machine that
has other work to do.
"""

import os
import sys
from collections.abc import Mapping
from contextlib import ExitStack, closing
from pathlib import Path
from typing import Any

import numpy as np

from experiment_manager.measures.tables import text_table
from tests.command_lines import configured
from tools.benchmark.graph import rate_hz, supervised_run
from tools.benchmark.loop import STAGES, LoopWindow, TimedLoop
from tools.benchmark.worker import ARGUMENTS, WARM_UP_ITERATIONS

_AT_ONCE = ["--set", "eyes.mechanics.moves=at_once"]
_LOOPS = {
    "in_process": ARGUMENTS,
    "in_process_pair_at_once": ARGUMENTS + _AT_ONCE,
    "in_process_twelve": ["--profile", "twelve", *ARGUMENTS[2:]],
}
_N_ENCODINGS = 300
# On two idle cores.
_AT_LEAST = {"graph_iterations_per_s": 240.0, "graph_to_in_process": 0.8}
_AT_MOST = {"encode_pair_ms": 0.6, "peak_memory_total_mb": 1536.0}


def measure(n_rounds: int, window_s: float, directory: Path) -> dict[str, Any]:
    """Return all results of one benchmark, as benchmark.sh writes them to JSON.

    directory: for the runs, empty. Raises RuntimeError when a graph does not start.
    """
    graph_hz: list[float] = []
    peaks_mb: dict[str, float] = {}
    windows: dict[str, list[LoopWindow]] = {name: [] for name in _LOOPS}
    with ExitStack() as stack:
        loops = {
            name: stack.enter_context(closing(TimedLoop(configured(*line))))
            for name, line in _LOOPS.items()
        }
        for loop in loops.values():
            loop.window(window_s / 2.0)
        for i_round in range(n_rounds):
            print(f"measuring round {i_round + 1} of {n_rounds}", file=sys.stderr, flush=True)
            with supervised_run(ARGUMENTS, directory / f"round_{i_round}") as graph:
                graph.await_start(WARM_UP_ITERATIONS)
                graph_hz.append(rate_hz(graph.window(window_s)))
                for name, peak_mb in graph.peak_memory_mb.items():
                    peaks_mb[name] = max(peaks_mb.get(name, 0.0), peak_mb)
            for name, loop in loops.items():
                windows[name].append(loop.window(window_s))
        encode_ms = loops["in_process"].encode_pair_ms(_N_ENCODINGS)
    loop_hz = {name: [window.rate_hz for window in of_one] for name, of_one in windows.items()}
    stages_ms = [window.stages_ms for window in windows["in_process"]]
    return {
        "graph_iterations_per_s": float(np.median(graph_hz)),
        **{f"{name}_iterations_per_s": float(np.median(hz)) for name, hz in loop_hz.items()},
        "graph_to_in_process": float(np.median(np.divide(graph_hz, loop_hz["in_process"]))),
        "encode_pair_ms": encode_ms,
        "stages_ms": {name: float(np.median([ms[name] for ms in stages_ms])) for name in STAGES},
        "peak_memory_mb": peaks_mb,
        "peak_memory_total_mb": sum(peaks_mb.values()),
        "n_cores": os.cpu_count(),
        "load_average": os.getloadavg()[0],
    }


def report(results: Mapping[str, Any]) -> str:
    """Return the table of a benchmark's JSON document; values in others are named outer.inner."""
    rows = []
    for name, value in results.items():
        if isinstance(value, Mapping):
            rows += [
                (f"{name}.{inner}", f"{number:.4g}", "", "") for inner, number in value.items()
            ]
        else:
            rows.append((name, f"{value:.4g}", *_judged(name, value)))
    return text_table(("what", "value", "bound", ""), rows)


def _judged(name: str, value: float) -> tuple[str, str]:
    """Return the bound of a number and whether it is met, in words, if it has one."""
    if name in _AT_LEAST:
        return f">= {_AT_LEAST[name]:g}", "ok" if value >= _AT_LEAST[name] else "MISSED"
    if name in _AT_MOST:
        return f"<= {_AT_MOST[name]:g}", "ok" if value <= _AT_MOST[name] else "MISSED"
    return "", ""
