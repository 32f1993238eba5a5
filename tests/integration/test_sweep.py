"""A sweep on this machine: its runs are those that run_experiment.sh makes, whatever happens."""

import os
import signal
import subprocess
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest
import yaml

from experiment_manager.sweep.sweep_file import read_sweep
from tests.patience import PATIENCE_S
from tests.supervised_run import SupervisedRun, differences, stamp_faults
from tests.supervisor import finished
from tests.sweep_harness import (
    are_held_at_first_checkpoint,
    command_line,
    goes_on_interrupted,
    start_sweep,
    whole_sweep,
    write_sweep,
)

_POLL_S = 0.02


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory, pictures: Path) -> Path:
    """Return the directory of a finished sweep."""
    return whole_sweep(tmp_path_factory, pictures)


@pytest.fixture
def sweep_file(whole: Path) -> Path:
    """Return what was asked for."""
    return whole.with_name("small.yaml")


def _wait_for(process: "subprocess.Popen[str]", condition: Callable[[], bool]) -> None:
    end_s = time.monotonic() + PATIENCE_S
    while not condition():
        assert process.poll() is None, process.communicate(timeout=PATIENCE_S)[0]
        assert time.monotonic() < end_s
        time.sleep(_POLL_S)


def test_each_run_is_the_run_of_its_command_line(whole, sweep_file, pictures, tmp_path) -> None:
    names = [*read_sweep(sweep_file).runs()]
    assert {path.name for path in whole.iterdir()} == {"sweep.yaml", "logs", *names}
    for name in names:
        assert stamp_faults(whole / name) == []
    second = tmp_path / "run"
    line = command_line(pictures, model="M_C", seed=2)
    with SupervisedRun(line, second, in_process=True) as run:
        assert run.wait() == 0, run.output()
    assert differences(whole / names[1], second) == []
    assert differences(whole / names[0], second) != []


def test_a_finished_sweep_is_left_alone(whole: Path, sweep_file: Path) -> None:
    before = {path: path.stat().st_mtime_ns for path in whole.rglob("*.mcap")}
    assert "3 done" in finished(start_sweep(sweep_file, "--out", whole))
    # A task of Slurm that is queued again, or submitted twice.
    assert "1/1 model_M_C-seed_1: done" in finished(start_sweep(whole, "--task", 0))
    assert {path: path.stat().st_mtime_ns for path in whole.rglob("*.mcap")} == before
    first = finished(start_sweep(whole, "--status")).splitlines()[1]
    assert first.split()[:5] == ["model_M_C-seed_1", "done", "360", "of", "360"]
    assert first.endswith(" deg at 200")


def test_a_sweep_that_is_stopped_and_then_killed_goes_on(whole, sweep_file, tmp_path) -> None:
    directory = tmp_path / "sweep"
    sweep = start_sweep(sweep_file, "--out", directory, "--jobs", 2)
    *runs, third = [directory / name for name in read_sweep(sweep_file).runs()]
    _wait_for(sweep, lambda: are_held_at_first_checkpoint(runs))
    sweep.send_signal(signal.SIGINT)
    for run in runs:
        _wait_for(sweep, partial(goes_on_interrupted, run))
    output = finished(sweep, code=130)
    assert f"to continue: launch_scripts/abv.sh sweep {directory}\n" in output
    assert "1 waiting" in output
    assert not [*directory.glob("*/results.json")]
    status = finished(start_sweep(directory, "--status"))
    assert "2 stopped, 1 waiting" in status
    # Goes on, is killed, and takes its runs with it: else the next one would find them at work.
    sweep = start_sweep(directory, "--jobs", 3)
    _wait_for(sweep, lambda: any(third.glob("checkpoints/*/manifest.json")))
    sweep.kill()
    sweep.communicate(timeout=PATIENCE_S)
    assert "3 done" in finished(start_sweep(directory, "--jobs", 3))
    for run in (*runs, third):
        assert differences(run, whole / run.name) == []


def test_ctrl_c_while_stimuli_are_made_is_one_line(tmp_path: Path) -> None:
    cache = tmp_path / "cache"
    generated = {
        "eye_plant.stimuli.cache_directory": str(cache),
        "eye_plant.stimuli.n_training": 100_000,
    }
    sweep_file = tmp_path / "small.yaml"
    sweep_file.write_text(yaml.safe_dump({"options": generated, "axes": {"seed": [1]}}))
    sweep = start_sweep(sweep_file, "--out", tmp_path / "sweep")
    _wait_for(sweep, lambda: any(cache.glob("*/*.npy")))
    os.killpg(sweep.pid, signal.SIGINT)
    output = finished(sweep, code=130)
    first, last = output.splitlines()
    assert first.endswith("; preparing their stimuli")
    assert last == "stopped before the first run"
    assert not (tmp_path / "sweep").exists()


def test_a_run_that_fails_leaves_the_others_alone(whole, pictures, tmp_path) -> None:
    axes: dict[str, list[object]] = {"model": ["M_C"], "seed": [1, 2]}
    sweep_file, directory = tmp_path / "two.yaml", tmp_path / "sweep"
    bad, other = read_sweep(write_sweep(sweep_file, pictures, axes)).runs()
    notes = directory / bad / "notes.txt"
    notes.parent.mkdir(parents=True)
    notes.write_text("mine")
    (directory / "sweep.yaml").write_text(read_sweep(sweep_file).text())
    output = finished(start_sweep(sweep_file, "--out", directory), code=3)
    failed = [line for line in output.splitlines() if line.startswith("failed: ")]
    assert len(failed) == 1
    assert f"failed: {bad}: {directory / bad}: expected a new or empty directory" in failed[0]
    assert f"log: {directory / 'logs' / bad}.log" in failed[0]
    assert "1 failed, 1 done" in output
    notes.unlink()
    finished(start_sweep(directory))
    for name in (bad, other):
        assert differences(directory / name, whole / name) == []
