"""Where the runs of a sweep stand, read from their directories alone."""

import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from experiment_manager.experiment.config import ExperimentManagerConfig
from experiment_manager.experiment.protocol import Protocol, make_protocol
from experiment_manager.experiment.sections import config_of
from experiment_manager.measures.results import Summary, read_results
from experiment_manager.measures.tables import text_table
from experiment_manager.run.config_file import read_configuration
from experiment_manager.run.run_directory import CONFIG_FILE, RESULTS_FILE
from experiment_manager.sweep.cell_run import CellRun
from lockstep import InputError

_COLUMNS = ("run", "state", "iterations", "it/s", "time left", "last test")
_MINUTE_S, _HOUR_S = 60, 3600
# Closer manifests are not from the run itself: --extend writes all of them again at once.
_LEAST_BETWEEN_S = 1.0


@dataclass(frozen=True)
class Status:
    """state: done, running, failed, stopped or waiting.

    iterations, n_iterations: those of training and of tests that are made, and all of them;
    rate_hz: between the last two checkpoints, None before, and after an extension until the next
    one; last_test: its summary, None before.
    """

    name: str
    state: str
    iterations: int = 0
    n_iterations: int = 0
    rate_hz: float | None = None
    last_test: Summary | None = None

    @property
    def left_s(self) -> float | None:
        """Time to go at that rate, None when nobody is at it."""
        if self.state != "running" or not self.rate_hz:
            return None
        return (self.n_iterations - self.iterations) / self.rate_hz

    def row(self) -> tuple[str, ...]:
        """Return the texts of a table's row."""
        has_rate = self.state == "running" and self.rate_hz is not None
        return (
            self.name,
            self.state,
            f"{self.iterations} of {self.n_iterations}" if self.n_iterations else "",
            f"{self.rate_hz:.0f}" if has_rate else "",
            _duration(self.left_s),
            _error(self.last_test),
        )


def status_of(run: CellRun) -> Status:
    """Return where a run stands; raises InputError for a directory that holds something else."""
    state = _state(run)
    if not (run.directory / CONFIG_FILE).exists():
        return Status(run.cell.name, state)
    configuration = read_configuration(run.directory / CONFIG_FILE)
    manager = config_of(ExperimentManagerConfig, configuration)
    protocol = make_protocol(manager)
    points = _checkpoints(run.directory)
    made = [_iterations_before(protocol, place) for place, _, _ in points]
    tests = read_results(run.directory / RESULTS_FILE).tests if run.is_done else ()
    if points and not tests:
        tests = points[-1][2]
    return Status(
        run.cell.name,
        state,
        made[-1] if made else 0,
        _iterations_before(protocol, len(protocol)),
        _rate_hz(made, [time_s for _, time_s, _ in points]),
        tests[-1] if tests else None,
    )


def table(statuses: Sequence[Status]) -> str:
    """Return the statuses as text, with a line of sums."""
    rows = [status.row() for status in statuses]
    counts = Counter(status.state for status in statuses)
    sums = ", ".join(f"{n} {state}" for state, n in counts.items())
    return f"{text_table(_COLUMNS, rows, n_left=len(_COLUMNS))}\n{sums}"


def _state(run: CellRun) -> str:
    if run.is_done:
        return "done"
    if run.is_running:
        return "running"
    if run.failure():
        return "failed"
    return "stopped" if run.directory.exists() else "waiting"


def _checkpoints(directory: Path) -> list[tuple[int, float, tuple[Summary, ...]]]:
    """Return episodes done, time (s) and tests of each checkpoint; none that is being removed."""
    found = []
    for path in sorted(directory.glob("checkpoints/*/manifest.json")):
        try:
            document = json.loads(path.read_bytes())
            time_s = path.stat().st_mtime
            tests = tuple(Summary.from_json(test) for test in document["progress"]["tests"])
            found.append((int(document["place"]), time_s, tests))
        except FileNotFoundError:
            continue
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise InputError(f"checkpoint {path}: expected a manifest: {error}") from error
    return found


def _rate_hz(made: Sequence[int], times_s: Sequence[float]) -> float | None:
    if len(made) < 2 or times_s[-1] - times_s[-2] < _LEAST_BETWEEN_S:
        return None
    return (made[-1] - made[-2]) / (times_s[-1] - times_s[-2])


def _iterations_before(protocol: Protocol, place: int) -> int:
    """Return the iterations, of training and of tests, that the episodes before a place make."""
    n_trials = protocol.trials_from(0) - protocol.trials_from(place)
    n_of_tests = n_trials * protocol.config.iterations_per_trial
    return protocol.training_iterations_before(place) + n_of_tests


def _duration(duration_s: float | None) -> str:
    if duration_s is None:
        return ""
    hours, rest_s = divmod(round(duration_s), _HOUR_S)
    return f"{hours}:{rest_s // _MINUTE_S:02} h"


def _error(test: Summary | None) -> str:
    if test is None:
        return ""
    median_deg = test.median_abs_vergence_error_deg
    error = "no trial" if median_deg is None else f"{median_deg:.3f} deg"
    return f"{error} at {test.iteration}"
