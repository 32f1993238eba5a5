"""report: one page that needs nothing beside it, with the paper's numbers and ours."""

import html
import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from active_binocular_vision import Run
from active_binocular_vision.commands import run
from active_binocular_vision.commands.report import main
from active_binocular_vision.figures.runs.learning_curve import performance_figure
from active_binocular_vision.runs.results_folder import runs_at
from experiment_manager.measures.kept_trials import with_test, write_trials
from experiment_manager.measures.results import write_document
from experiment_manager.measures.tables import percent
from experiment_manager.run import checkpoint
from experiment_manager.run.checkpoint import Manifest
from experiment_manager.run.progress import Progress
from lockstep.command_space import ALL_MUSCLES, PAIR
from lockstep.files.state_file import write_state
from tests.active_binocular_vision.own_commands import write_run
from tests.pair import PAIR_SPACE


def _with_checkpoint(directory: Path) -> None:
    below = checkpoint.place_directory(directory / "checkpoints", 5)
    below.mkdir(parents=True)
    atoms = np.random.default_rng(0).normal(size=(2, 30, 128)).astype(np.float32)
    write_state(below / "sparse_coder.npz", "sparse_coder", {"atoms": atoms})
    hashes = {"sparse_coder.npz": checkpoint.hash_of(below / "sparse_coder.npz")}
    progress = Progress(0, PAIR_SPACE).state()
    manifest = Manifest(5, {"vergence_rl": {}}, ("bag_0.mcap",), hashes, progress)
    checkpoint.commit(directory / "checkpoints", manifest)


def test_the_report_of_two_models(run_directories, tmp_path, capsys) -> None:
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
    assert text.count("<div><table>") == text.count("<table>") > 0, "wide ones scroll by themselves"
    assert "0 %" in text
    assert "-0.0 %" not in text
    assert re.search(r"<td>[0-9.]+ % \(all 400\)</td>", text), "there were no 5,000 iterations"

    trials = Run(runs[0]).recorded.tests[-1].trials
    median_deg = np.median(np.abs(trials.vergence_error_deg[:, 20]))
    cells = _cells(text, "our test set: median |vergence error| / deg")
    assert cells[:3] == ["-", f"{median_deg:.3f}", "-"], "the paper tells the other set alone"
    start_deg = np.round(trials.vergence_error_deg[:, 0])
    small = trials.chosen((np.abs(start_deg) <= 3) & (start_deg != 0) & (start_deg != 3))
    median_deg = np.median(np.abs(small.vergence_error_deg[:, 20]))
    cells = _cells(text, "starts up to 2 deg: median |vergence error| / deg")
    assert cells[:3] == ["0.07", f"{median_deg:.3f}", "0.176"], "paper beside ours"
    for told in ("commit 0123abc", "mujoco 4.0.0", "metabolic_cost_weight: 0.08", "101.7 %"):
        assert told in text


def test_a_page_says_of_each_command_space_what_holds_for_it(tmp_path: Path) -> None:
    run = write_run(tmp_path / "twelve", ALL_MUSCLES)
    assert main([str(run)]) == 0
    assert (run / "figures" / "performance.png").is_file()
    text = _page(run)
    assert "and a plane of two activations, those of both eyes alike: twelve." in text
    assert "Where each muscle has a command of its own" in text
    assert "median |cyclovergence error| / deg" in text
    assert "superior oblique and inferior oblique" in text
    for of_pair in ("paper, M", "The paper and ours", "up to 2 m", "starts up to 2 deg"):
        assert of_pair not in text
    pair = write_run(tmp_path / "pair", PAIR)
    assert main([str(pair), str(run), "--out", str(tmp_path / "both")]) == 0
    text = _page(tmp_path / "both")
    for of_both in ("paper, M", "up to 2 m", "Where each muscle has a command of its own"):
        assert of_both in text


def test_a_figure_that_fails_does_not_cost_the_end_of_a_run(tmp_path, monkeypatch, capsys) -> None:
    def without_latex(directory: Path) -> Path:
        raise RuntimeError("latex could not be found")

    monkeypatch.setattr(f"{performance_figure.__module__}.learning_curve", without_latex)
    assert run.figure_of(tmp_path) is None
    assert capsys.readouterr().err == "no learning curve: latex could not be found\n"


def test_what_is_no_run_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"error: {tmp_path}: expected a run, with results.json or a bag")
    assert error.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


@pytest.fixture(scope="module")
def kept(run_directories: dict[str, Path], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A sweep: both models, two seeds each, as they are committed, without their bags."""
    sweep = tmp_path_factory.mktemp("kept") / "sweep"
    for model, directory in run_directories.items():
        copy = Path(shutil.copytree(directory, sweep / f"{model}_1"))
        run = Run(copy)
        (copy / "config.yaml").write_text(run.configuration_text)
        write_document(copy / "results.json", run.results_of_bag())
        kept = None
        for test in run.recorded.tests:
            kept = with_test(kept, test.trials)
        write_trials(copy, kept)
        shutil.rmtree(copy / "bag")
        other = Path(shutil.copytree(copy, sweep / f"{model}_2"))
        text = (other / "config.yaml").read_text()
        (other / "config.yaml").write_text(text.replace("seed: 1", "seed: 2"))
        document = json.loads((other / "results.json").read_text())
        document["tests"][-1]["median_abs_vergence_error_deg"] *= 3
        (other / "results.json").write_text(json.dumps(document))
    (sweep / "sweep.yaml").write_text("options: {}\n")
    return sweep


def _page(directory: Path) -> str:
    return html.unescape((directory / "report.html").read_text())


def _cells(text: str, name: str) -> list[str]:
    row = next(line for line in text.splitlines() if f"<td>{name}</td>" in line)
    return re.findall(r"<td>([^<]*)</td>", row)[1:]


def test_a_sweep_without_bags_pools_its_seeds(kept, run_directories, capsys) -> None:
    (kept / "unfinished").mkdir()
    (kept / "unfinished" / "config.yaml").write_text("run: {}\n")
    assert main([str(kept)]) == 0
    assert capsys.readouterr().err.startswith(f"left out: {kept / 'unfinished'}: expected a run")
    text = _page(kept)
    assert {path.stem for path in (kept / "figures").iterdir()} == {
        "performance",
        "boxes",
        "motor_space",
        "conditions",
    }
    assert "a test in a bag, with enough observations in a bin: M_1, M_2, M_C_1, M_C_2." in text
    whole = Run(run_directories["M"]).summaries[-1]
    median_deg = whole.median_abs_vergence_error_deg
    assert median_deg is not None
    assert _cells(text, "our test set: trials")[1] == "78", "those of both seeds"
    # Pooled: the trials are the same twice. Over seeds: one has three times the median.
    ours = "our test set: median |vergence error| / deg"
    assert _cells(text, ours)[1] == f"{median_deg:.3f}"
    # Of two seeds t is 12.706, and the standard deviation sqrt(2) medians.
    told = f"{2 * median_deg:.3f} ± {12.706 * median_deg:.3f} ({median_deg:.3f} to "
    assert told + f"{3 * median_deg:.3f})" in text


def test_results_alone_are_shown_as_far_as_they_go(kept, tmp_path, capsys) -> None:
    old = Path(shutil.copytree(kept / "M_1", tmp_path / "results" / "old"))
    (old / "trials.npz").unlink()
    (tmp_path / "results" / "README.md").write_text("")
    out = tmp_path / "out"
    assert main([*map(str, sorted((tmp_path / "results").iterdir())), "--out", str(out)]) == 0
    assert "README.md" in capsys.readouterr().err
    text = _page(out)
    assert [path.stem for path in (out / "figures").iterdir()] == ["performance"]
    assert "Without quartiles, which need trials.npz or a bag: old." in text
    assert "Not drawn without trials.npz or a bag: old." in text
    told = json.loads((old / "results.json").read_text())["tests"][-1]
    expected = percent(told["share_within_1_px"])
    assert _cells(text, "our test set: within 1 px")[1] == expected


def test_the_runs_that_are_kept_make_a_report(tmp_path: Path) -> None:
    results = Path(__file__).parents[3] / "results"
    sweeps = results / "twelve", results / "gaze_saliency"
    runs = [sweep / runs_at(sweep)[0].name for sweep in sweeps]
    assert main([*map(str, runs), "--out", str(tmp_path)]) == 0
    assert (tmp_path / "figures" / "performance.png").is_file()


def test_a_sweep_without_any_finished_run_is_one_line(tmp_path, capsys) -> None:
    (tmp_path / "sweep.yaml").write_text("")
    assert main([str(tmp_path)]) == 2
    assert capsys.readouterr().err == f"error: {tmp_path}: expected runs in the sweep\n"
