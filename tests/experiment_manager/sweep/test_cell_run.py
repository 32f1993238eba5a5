"""Who is at a run of a sweep, how it ended, and where it stands, as its files tell."""

import json
import os
import subprocess
import sys
from pathlib import Path

import msgspec
import pytest

from experiment_manager.preparation.request import RunRequest
from experiment_manager.run.checkpoint import Manifest
from experiment_manager.run.config_file import configuration_text
from experiment_manager.run.progress import ProgressState, Sums
from experiment_manager.sweep.cell_run import CellRun, is_failure
from experiment_manager.sweep.pool import Pool
from experiment_manager.sweep.status import Status, status_of, table
from experiment_manager.sweep.sweep_file import Cell
from lockstep.exit_codes import EXIT_FAULT
from tests.experiment_manager.summaries import summary


@pytest.fixture
def run(tmp_path: Path, pictures: Path) -> CellRun:
    """Return a run of 200 iterations between two tests of 39 trials, not begun."""
    request = RunRequest(iterations=200, tests=(0,), test_stimuli=1, stimuli=str(pictures))
    (tmp_path / "logs").mkdir()
    return CellRun(tmp_path, Cell("seed_1", request))


def _begin(run: CellRun, *points: tuple[int, float]) -> None:
    """Write the configuration, and a checkpoint for each (episodes done, time)."""
    run.directory.mkdir()
    configuration = run.cell.configuration("0123abc")
    (run.directory / "config.yaml").write_text(configuration_text(configuration))
    for place, time_s in points:
        path = run.directory / "checkpoints" / f"{place:09d}" / "manifest.json"
        path.parent.mkdir(parents=True)
        tests = [summary(median_abs_vergence_error_deg=1.5)] if place > 39 else []
        progress = ProgressState(tests, Sums(), Sums(), [])
        path.write_bytes(msgspec.json.encode(Manifest(place, {}, (), {}, progress)))
        os.utime(path, (time_s, time_s))


def test_a_run_that_nobody_has_begun_waits(run: CellRun) -> None:
    assert status_of(run) == Status("seed_1", "waiting")
    assert run.failure() == ""


def test_a_run_stands_where_its_newest_checkpoint_is(run: CellRun) -> None:
    # 39 trials of 20 iterations, then episodes of 10: 5 of them in 2 s.
    _begin(run, (44, 100.0), (49, 102.0))
    status = status_of(run)
    assert (status.state, status.iterations, status.n_iterations) == ("stopped", 880, 1760)
    assert status.rate_hz == pytest.approx(25.0)
    assert status.left_s is None
    assert status.last_test is not None
    assert status.last_test.iteration == 0


def test_an_extended_run_has_no_rate_until_its_next_checkpoint(run: CellRun) -> None:
    _begin(run, (44, 100.0), (49, 100.002))  # --extend writes both again
    assert status_of(run).rate_hz is None


def test_a_run_is_running_as_long_as_a_process_holds_its_log(run: CellRun) -> None:
    _begin(run, (39, 100.0), (44, 101.0))
    # The child takes the lock with the open file; both ends of it must be gone.
    code = "import fcntl, sys; fcntl.flock(1, fcntl.LOCK_EX); print('held'); sys.stdin.read()"
    with run.log.open("ab") as log:
        holder = subprocess.Popen(
            [sys.executable, "-u", "-c", code], stdin=subprocess.PIPE, stdout=log
        )
    try:
        while b"held" not in run.log.read_bytes():
            assert holder.poll() is None
        status = status_of(run)
        assert status.state == "running"
        assert status.left_s == pytest.approx((1760 - 830) / 50.0)
        assert run.run(lambda process: None) is None
    finally:
        holder.communicate()
    assert status_of(run).state == "stopped"


def test_a_run_is_done_until_it_is_made_longer(run: CellRun) -> None:
    _begin(run)
    was_done = [run.is_done]
    shares = {"first_5000": None, "last_5000": None}
    results = {"model": "M", "profile": "", "seed": 1, "iterations": 200, "commit": ""}
    document = json.dumps(results | {"lambda": 0.0, "lambda_share": shares, "tests": []})
    (run.directory / "results.json").write_text(document)
    was_done.append(run.is_done)
    config = run.directory / "config.yaml"
    text = config.read_text()
    config.write_text(text.replace("n_training_iterations: 200", "n_training_iterations: 300"))
    was_done.append(run.is_done)
    for damaged in (b"", b"\xff" + text.encode()):
        config.write_bytes(damaged)
        was_done.append(run.is_done)
    assert was_done == [False, True, False, False, False]


def test_a_run_whose_log_cannot_be_written_fails_alone(tmp_path, capsys) -> None:
    (tmp_path / "logs").write_text("in the way")
    runs = [CellRun(tmp_path, Cell(name, RunRequest())) for name in ("seed_1", "seed_2")]
    assert Pool(1).run(runs) == EXIT_FAULT
    said = capsys.readouterr().err
    for run in runs:
        assert f"failed: {run.cell.name}: [Errno 17] File exists" in said


@pytest.mark.parametrize(
    ("log", "failure"),
    [
        ("error: what it was\r\nto continue: x\n\nended with exit code 3\n", "what it was"),
        ("a line\nended with exit code -9\n", "ended with exit code -9"),
        ("error: old\nended with exit code 3\nonce more\n", ""),
        ("stopping\nended with exit code 130\n", ""),
        ("KeyboardInterrupt\nended with exit code -2\n", ""),
        ("ended with exit code 0\n", ""),
        ("", ""),
    ],
)
def test_how_a_run_ended_is_the_end_of_its_log(run: CellRun, log: str, failure: str) -> None:
    run.log.write_text(log)
    assert run.failure() == failure
    assert status_of(run).state == ("failed" if failure else "waiting")


@pytest.mark.parametrize(
    ("code", "failed", "failed_when_interrupted"),
    [
        (0, False, False),
        (130, False, False),
        (3, True, True),
        (2, True, True),
        (-9, True, False),
        (1, True, False),
    ],
)
def test_which_ends_are_failures(code: int, failed: bool, failed_when_interrupted: bool) -> None:
    assert is_failure(code, interrupted=False) == failed
    assert is_failure(code, interrupted=True) == failed_when_interrupted


def test_the_table_has_a_row_for_each_run_and_their_sums() -> None:
    last_test = summary(iteration=1000, median_abs_vergence_error_deg=0.0852)
    statuses = [
        Status("seed_1", "running", 36_000, 1_000_000, 50.0, last_test),
        Status("seed_10", "waiting"),
        Status("seed_2", "waiting"),
        Status("seed_3", "done", 40, 40, last_test=summary(iteration=1000)),
    ]
    assert table(statuses).splitlines() == [
        "run      state    iterations        it/s  time left  last test",
        "seed_1   running  36000 of 1000000  50    5:21 h     0.085 deg at 1000",
        "seed_10  waiting",
        "seed_2   waiting",
        "seed_3   done     40 of 40                           no trial at 1000",
        "1 running, 2 waiting, 1 done",
    ]
