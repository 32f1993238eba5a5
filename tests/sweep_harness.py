"""Sweeps of runs small enough for tests, as processes."""

import signal
import subprocess
from collections.abc import Sequence
from pathlib import Path

import psutil
import pytest
import yaml

from tests.command_lines import set_words
from tests.graph_harness import SCRIPTS
from tests.made_once import made_once
from tests.supervisor import finished, started

OPTIONS = {
    "profile": "paper",
    "iterations": 200,
    "tests": [0],
    "test-stimuli": 1,
    "eye_plant.stimuli.size_px": 64,
    "eyes.camera.roi_width_px": 130,
    "eyes.camera.roi_height_px": 130,
    "task.n_bases": 32,
    "experiment_manager.test_distances_m": [1.0],
    "experiment_manager.least_start_error_deg": 0,
    "experiment_manager.checkpoint_period_s": 0.1,
}


def write_sweep(path: Path, pictures: Path, axes: dict[str, list[object]], **more: object) -> Path:
    """Write a sweep of small runs; more: further options."""
    options = OPTIONS | {"stimuli": str(pictures)} | more
    path.write_text(yaml.safe_dump({"options": options, "axes": axes}, sort_keys=False))
    return path


def whole_sweep(tmp_path_factory: pytest.TempPathFactory, pictures: Path) -> Path:
    """Return the directory of a finished sweep of three seeds, of a local pool; not to change.

    Its file is beside it, as small.yaml.
    """

    def make(directory: Path) -> None:
        axes: dict[str, list[object]] = {"model": ["M_C"], "seed": [1, 2, 3]}
        sweep_file = write_sweep(directory / "small.yaml", pictures, axes)
        output = finished(start_sweep(sweep_file, "--out", directory / "sweep", "--jobs", 2))
        assert "3/3 model_M_C-seed_" in output
        assert "3 done" in output

    return made_once(tmp_path_factory, "whole_sweep", make) / "sweep"


def command_line(pictures: Path, **more: object) -> list[str]:
    """Return the command line of one run of a sweep; more: further options."""
    words: list[str] = []
    for name, value in (OPTIONS | {"stimuli": pictures} | more).items():
        if "." in name:
            words += set_words({name: value})
        else:
            text = ",".join(map(str, value)) if isinstance(value, list) else str(value)
            words += [f"--{name}", text]
    return words


def start_sweep(*line: object, **variables: str) -> "subprocess.Popen[str]":
    """Start sweep.sh; its output is one stream. variables: more of its environment."""
    return started(
        # Whoever runs the tests in the background may have the interrupt ignored.
        ["env", "--default-signal=INT", SCRIPTS / "sweep.sh", *map(str, line)],
        variables,
        start_new_session=True,  # its group can be sent what Ctrl-C in a terminal sends
    )


def process_of(run: Path) -> psutil.Process:
    """Return the process that makes a run of a sweep, on this machine."""
    for process in psutil.process_iter(["cmdline"]):
        words = process.info["cmdline"] or []
        if "active_binocular_vision.commands.sweep_run" in words and str(run) in words:
            return process
    raise AssertionError(f"expected a process that makes {run}, found none")


def are_held_at_first_checkpoint(runs: Sequence[Path]) -> bool:
    """Stop the process of each run that has a checkpoint; return whether all have stopped.

    What is done to the runs then cannot come after their end; goes_on_interrupted lets them go on.
    A process stops when it next gets a core; a signal that comes before would be taken first.
    """
    begun = [process_of(run) for run in runs if any(run.glob("checkpoints/*/manifest.json"))]
    for process in begun:
        process.suspend()
    return [process.status() for process in begun] == [psutil.STATUS_STOPPED] * len(runs)


def goes_on_interrupted(run: Path) -> bool:
    """Let a held run go on once SIGINT has been sent to it; return whether that has come."""
    process = process_of(run)
    status = Path(f"/proc/{process.pid}/status").read_text()
    pending = next(line for line in status.splitlines() if line.startswith("ShdPnd:"))
    if not int(pending.split()[1], 16) & 1 << signal.SIGINT - 1:
        return False
    process.resume()
    return True
