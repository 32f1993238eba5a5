"""report: one page that needs nothing beside it, with the paper's numbers and ours."""

import html
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from experiment_manager.commands.report import main
from experiment_manager.measures.recorded_run import RecordedRun
from experiment_manager.run import checkpoint
from experiment_manager.run.checkpoint import Manifest


def _with_checkpoint(directory: Path) -> None:
    below = checkpoint.place_directory(directory / "checkpoints", 5)
    below.mkdir(parents=True)
    atoms = np.random.default_rng(0).normal(size=(2, 30, 128)).astype(np.float32)
    np.savez(below / "sparse_coder.npz", atoms=atoms)
    hashes = {"sparse_coder.npz": checkpoint.hash_of(below / "sparse_coder.npz")}
    manifest = Manifest(5, {"vergence_rl": {}}, ("bag_0.mcap",), hashes, {})
    checkpoint.commit(directory / "checkpoints", manifest)


def test_the_report_of_two_models(
    run_directories: dict[str, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    runs = [Path(shutil.copytree(path, tmp_path / name)) for name, path in run_directories.items()]
    _with_checkpoint(runs[0])
    out = tmp_path / "out"
    assert main([*map(str, runs), "--out", str(out)]) == 0
    assert capsys.readouterr().out == f"{out / 'report.html'}\n"
    text = html.unescape((out / "report.html").read_text())

    sources = re.findall(r'(?:src|href)="([^"]{0,30})', text)
    assert len(sources) == 8, "Fig. 2, 3, 4, conditions, encoding, a dictionary, two anaglyphs"
    assert all(source.startswith("data:image/png;base64,") for source in sources)
    assert sorted(path.name for path in (out / "figures").iterdir()) == [
        "anaglyphs_0_M.png",
        "anaglyphs_1_M_C.png",
        "boxes.png",
        "conditions.png",
        "dictionaries_0_M.png",
        "encoding.png",
        "motor_space.png",
        "performance.png",
    ]
    assert "M_C has no checkpoint to take basis functions from." in text

    trials = RecordedRun(runs[0]).tests[-1].trials
    median_deg = np.median(np.abs(trials.vergence_error_deg[:, 20]))
    row = next(line for line in text.splitlines() if "our test set: median |error|" in line)
    cells = re.findall(r"<td>([^<]*)</td>", row)
    assert cells[1:4] == ["-", f"{median_deg:.3f}", "-"], "the paper tells the authors' alone"
    start_deg = np.round(trials.vergence_error_deg[:, 0])
    authors = trials.chosen((np.abs(start_deg) <= 3) & (start_deg != 0) & (start_deg != 3))
    median_deg = np.median(np.abs(authors.vergence_error_deg[:, 20]))
    row = next(line for line in text.splitlines() if "authors' test set: median |error|" in line)
    cells = re.findall(r"<td>([^<]*)</td>", row)
    assert cells[1:4] == ["0.07", f"{median_deg:.3f}", "0.176"], "paper beside ours"
    for told in ("commit 0123abc", "mujoco 4.0.0", "metabolic_cost_weight: 0.08", "101.7 %"):
        assert told in text


def test_a_single_run_has_its_report_in_its_directory(
    run_directories: dict[str, Path], tmp_path: Path
) -> None:
    directory = Path(shutil.copytree(run_directories["M"], tmp_path / "run"))
    assert main([str(directory)]) == 0
    assert (directory / "report.html").is_file()
    assert (directory / "figures" / "performance.png").is_file()


def test_what_is_no_run_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert error.startswith("error: expected a bag directory")
    assert error.count("\n") == 1
    assert list(tmp_path.iterdir()) == []
