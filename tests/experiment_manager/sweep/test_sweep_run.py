"""Who is at a run of a sweep, how it ended, and where it stands, as its files tell."""

import json
import os
import subprocess
import sys
from pathlib import Path

import msgspec
import pytest

from experiment_manager import RunRequest, configuration_of
from experiment_manager.run.checkpoint import Manifest
from experiment_manager.run.config_file import configuration_text
from experiment_manager.run.progress import ProgressState, Sums
from experiment_manager.sweep.pool import Pool
from experiment_manager.sweep.status import table
from experiment_manager.sweep.sweep_run import SweepRun
from lockstep.exit_codes import EXIT_FAULT
from tests.experiment_manager.summaries import summary
from tests.patience import PATIENCE_S


@pytest.fixture
def run(tmp_path: Path) -> SweepRun:
    """Return a run that is not begun."""
    (tmp_path / "logs").mkdir()
    return SweepRun(tmp_path, "seed_1")


def _begin(run: SweepRun, pictures: Path, *points: tuple[int, float]) -> None:
    """Begin a run of 200 iterations between two tests of 39 trials.

    points: (episodes done, time in s) of each checkpoint.
    """
    run.directory.mkdir()
    request = RunRequest(iterations=200, tests=(0,), test_stimuli=1, stimuli=str(pictures))
    configuration = configuration_of(request, "0123abc")
    (run.directory / "config.yaml").write_text(configuration_text(configuration))
    for place, time_s in points:
        path = run.directory / "checkpoints" / f"{place:09d}" / "manifest.json"
        path.parent.mkdir(parents=True)
        tests = [summary(median_abs_vergence_error_deg=1.5)] if place > 39 else []
        progress = ProgressState(tests, Sums(), Sums(), [])
        path.write_bytes(msgspec.json.encode(Manifest(place, {}, (), {}, progress)))
        os.utime(path, (time_s, time_s))


@pytest.mark.parametrize(
    ("times_s", "rate"),
    [
        ((100.0, 102.0), ["25", "0.0 h"]),
        ((100.0, 100.002), []),  # --extend writes both again
    ],
)
def test_a_run_is_running_as_long_as_a_process_holds_its_log(run, pictures, times_s, rate) -> None:
    # 39 trials of 20 iterations, then episodes of 10.
    _begin(run, pictures, (44, times_s[0]), (49, times_s[1]))
    place = ["880", "of", "1760"]
    test = ["1.500", "deg", "at", "0"]
    # The child takes the lock with the open file; both ends of it must be gone.
    code = "import fcntl, sys; fcntl.flock(1, fcntl.LOCK_EX); print('held'); sys.stdin.read()"
    with run.log.open("ab") as log:
        holder = subprocess.Popen(
            [sys.executable, "-u", "-c", code], stdin=subprocess.PIPE, stdout=log
        )
    try:
        while b"held" not in run.log.read_bytes():
            assert holder.poll() is None
        words = " ".join(rate).split()
        assert table([run]).splitlines()[1].split() == ["seed_1", "running", *place, *words, *test]
        assert not run.make(["nothing"], lambda process: None)
    finally:
        holder.communicate(timeout=PATIENCE_S)
    assert table([run]).splitlines()[1].split() == ["seed_1", "stopped", *place, *test]


def test_a_run_is_done_until_it_is_made_longer(run: SweepRun, pictures: Path) -> None:
    _begin(run, pictures)
    states = [run.state]
    shares = {"first_5000": None, "last_5000": None}
    results = {"model": "M", "profile": "", "seed": 1, "iterations": 200, "commit": ""}
    document = json.dumps(results | {"lambda": 0.0, "lambda_share": shares, "tests": []})
    (run.directory / "results.json").write_text(document)
    states.append(run.state)
    config = run.directory / "config.yaml"
    text = config.read_text()
    config.write_text(text.replace("n_training_iterations: 200", "n_training_iterations: 300"))
    states.append(run.state)
    for damaged in (b"", b"\xff" + text.encode()):
        config.write_bytes(damaged)
        states.append(run.state)
    assert states == ["stopped", "done", "stopped", "stopped", "stopped"]


def test_a_run_whose_log_cannot_be_written_fails_alone(tmp_path, capsys) -> None:
    (tmp_path / "logs").write_text("in the way")
    runs = [SweepRun(tmp_path, name) for name in ("seed_1", "seed_2")]
    assert Pool(1, ["nothing"]).run(runs) == EXIT_FAULT
    said = capsys.readouterr().err
    for run in runs:
        assert f"failed: {run.name}: [Errno 17] File exists" in said


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
def test_how_a_run_ended_is_the_end_of_its_log(run: SweepRun, log: str, failure: str) -> None:
    run.log.write_text(log)
    assert run.failure() == failure
    assert run.state == ("failed" if failure else "waiting")


def test_the_table_has_a_row_for_each_run_and_their_sums(run, pictures) -> None:
    _begin(run, pictures, (44, 100.0))
    others = [SweepRun(run.directory.parent, name) for name in ("seed_10", "seed_2")]
    assert table([run, *others]).splitlines() == [
        "run      state    iterations   it/s  time left  last test",
        "seed_1   stopped  830 of 1760                   1.500 deg at 0",
        "seed_10  waiting",
        "seed_2   waiting",
        "1 stopped, 2 waiting",
    ]
