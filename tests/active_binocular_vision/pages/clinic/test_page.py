"""report.sh --clinic on a small run whose eyes are corrected half-way."""

import json
import math
import shutil
import sys
from contextlib import redirect_stdout
from pathlib import Path

import numpy as np
import pytest

from active_binocular_vision.commands.report import main
from active_binocular_vision.commands.run_experiment import main as run_experiment
from active_binocular_vision.runs.examined_run import EXAMINED_FILE, ExaminedRun
from experiment_manager.measures.kept_trials import read_trials
from tests.command_lines import set_words
from tests.made_once import made_once

_HEALTHY = f"{{eyes.mechanics.recession_mm: {[0.0] * 12}}}"
_SETTINGS = {
    "task.schedule": f"[{{at: 40, set: {_HEALTHY}}}]",
    "experiment_manager.test_distances_m": "[2.0]",
    "experiment_manager.n_starts_per_distance": 1,
    "eye_plant.stimuli.size_px": 64,
    "task.n_bases": 20,
}


@pytest.fixture
def run(tmp_path_factory: pytest.TempPathFactory, pictures: Path, tmp_path: Path) -> Path:
    """Return the directory of a run of 80 iterations, one's own to change."""

    def make(directory: Path) -> None:
        line = ["--in-process", "--profile", "clinic/esotropia_10", "--iterations", "80"]
        line += ["--tests", "0,40", "--test-stimuli", "1", "--stimuli", str(pictures)]
        line += set_words(_SETTINGS)
        with redirect_stdout(sys.stderr):
            assert run_experiment([*line, "--out", str(directory / "run")]) == 0

    made = made_once(tmp_path_factory, "clinic_corrected", make) / "run"
    return Path(shutil.copytree(made, tmp_path / "run"))


def test_a_run_is_examined_once_at_three_ages(run: Path, tmp_path: Path, capsys) -> None:
    out = tmp_path / "out"
    assert main([str(run), str(tmp_path / "none"), "--clinic", "--out", str(out)]) == 0
    printed = capsys.readouterr()
    assert printed.out == f"{out / 'clinic.html'}\n"
    assert f"left out: expected {tmp_path / 'none' / 'results.json'}" in printed.err
    assert (out / "figures" / "clinic.png").is_file()
    page = (out / "clinic.html").read_text()
    assert page.count("<td>esotropia 10°</td>") == 3

    examined = ExaminedRun.read(run)
    assert examined is not None
    assert (examined.changed_at, examined.final_learning_rate) == (40, 0.0)
    assert [(age.when, age.iteration) for age in examined.ages] == [
        ("birth", 0),
        ("before", 40),
        ("end", 80),
    ]
    # Eyes that have not learned to move stay at rest: 10 deg inward, then straight ahead, while the
    # object needs atan(0.056 / 2) of convergence.
    needed_deg = math.degrees(math.atan(0.056 / 2.0))
    for age, turned_deg in zip(examined.ages, (10.0, 10.0, 0.0), strict=True):
        expected_pd = 100.0 * math.tan(math.radians(turned_deg - needed_deg))
        assert age.horizontal_deviation_pd == pytest.approx(expected_pd, abs=0.1)
        assert age.share_fused == 0.0
    last = read_trials(run)[-1]
    assert examined.ages[-1].metabolic_rate_w == np.median(last.metabolic_rate_w[:, -1])

    # Again, from the file alone.
    shutil.rmtree(run / "checkpoints")
    assert main([str(run), "--clinic", "--out", str(out)]) == 0
    assert (out / "clinic.html").read_text() == page


def test_what_cannot_be_examined_is_one_line(run: Path, tmp_path: Path, capsys) -> None:
    shutil.rmtree(run / "checkpoints")
    results = json.loads((run / "results.json").read_text())
    assert main([str(run), "--clinic", "--out", str(tmp_path / "out")]) == 2
    assert "expected a checkpoint after 0 episodes" in capsys.readouterr().err
    results["tests"].pop()
    (run / "results.json").write_text(json.dumps(results))
    assert main([str(run), "--clinic", "--out", str(tmp_path / "out")]) == 2
    assert capsys.readouterr().err.endswith("expected a run with a test at its end, 80\n")
    assert not (tmp_path / "out").exists()
    assert not (run / EXAMINED_FILE).exists()
