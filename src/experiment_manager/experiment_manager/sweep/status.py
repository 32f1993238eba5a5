"""Where the runs of a sweep stand, read from their directories alone."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from experiment_manager.measures.results import RESULTS_FILE, Summary, read_results
from experiment_manager.measures.tables import text_table
from experiment_manager.protocol import protocol_of
from experiment_manager.run import checkpoint
from experiment_manager.run.config_file import CONFIG_FILE, read_configuration
from experiment_manager.sweep.sweep_run import SweepRun

_COLUMNS = ("run", "state", "iterations", "it/s", "time left", "last test")
_HOUR_S = 3600
# Closer manifests are not from the run itself: --extend writes all of them again at once.
_LEAST_BETWEEN_S = 1.0


def table(runs: Sequence[SweepRun]) -> str:
    """Return where runs stand as text, a line for each and one of sums.

    Raises InputError for a directory that holds something else.
    """
    states = [run.state for run in runs]
    rows = [
        (run.name, state, *_progress(run, state)) for run, state in zip(runs, states, strict=True)
    ]
    sums = ", ".join(f"{n} {state}" for state, n in Counter(states).items())
    return f"{text_table(_COLUMNS, rows, n_left=len(_COLUMNS))}\n{sums}"


def _progress(run: SweepRun, state: str) -> tuple[str, str, str, str]:
    """Return the texts of iterations, rate, time left and last test; "" for what is not known.

    Iterations are those of training and of tests; the rate is that between the last checkpoints.
    """
    if not (run.directory / CONFIG_FILE).exists():
        return "", "", "", ""
    configuration = read_configuration(run.directory / CONFIG_FILE)
    protocol = protocol_of(configuration)
    points = _checkpoints(run.directory)
    made = [protocol.iterations_before(place) for place, _, _ in points] or [0]
    n_iterations = protocol.iterations_before(len(protocol))
    rate, left = "", ""
    if state == "running" and len(points) > 1:
        between_s = points[-1][1] - points[-2][1]
        if between_s >= _LEAST_BETWEEN_S:
            rate_hz = (made[-1] - made[-2]) / between_s
            rate, left = f"{rate_hz:.0f}", f"{(n_iterations - made[-1]) / rate_hz / _HOUR_S:.1f} h"
    tests = points[-1][2] if points else ()
    if state == "done":
        tests = read_results(run.directory / RESULTS_FILE).tests or tests
    return f"{made[-1]} of {n_iterations}", rate, left, _error(tests)


def _checkpoints(directory: Path) -> list[tuple[int, float, tuple[Summary, ...]]]:
    """Return episodes done, time (s) and tests of each checkpoint; none that is being removed."""
    found = []
    for path in sorted(directory.glob("checkpoints/*/manifest.json")):
        try:
            manifest, time_s = checkpoint.read(path), path.stat().st_mtime
            found.append((manifest.place, time_s, tuple(manifest.progress.tests)))
        except FileNotFoundError:
            continue
    return found


def _error(tests: Sequence[Summary]) -> str:
    if not tests:
        return ""
    median_deg = tests[-1].median_abs_vergence_error_deg
    error = "no trial" if median_deg is None else f"{median_deg:.3f} deg"
    return f"{error} at {tests[-1].iteration}"
