"""What sweep.sh refuses before it does anything."""

import pytest

from active_binocular_vision.commands.sweep import main
from experiment_manager import configuration_of
from experiment_manager.run.config_file import configuration_text
from experiment_manager.sweep.sweep_file import read_sweep
from tests.sweep_harness import write_sweep


@pytest.mark.parametrize(
    ("words", "error"),
    [
        (["--jobs", "0"], "--jobs: expected 1 or more, got 0"),
        (["--partition", "fast"], "--partition: expected it with --slurm only"),
        (["--slurm", "--jobs", "2"], "--jobs: expected it without --slurm, which has --tasks"),
        (["--slurm", "--tasks", "0"], "--tasks: expected 1 or more, got 0"),
        (["--slurm"], "--slurm: expected sbatch on this machine, found none"),
    ],
)
def test_bad_options_are_one_error(
    pictures, tmp_path, monkeypatch, capsys, *, words, error
) -> None:
    monkeypatch.setenv("PATH", "")
    sweep = write_sweep(tmp_path / "small.yaml", pictures, {"seed": [1, 2]})
    assert main([str(sweep), "--out", str(tmp_path / "out"), *words]) == 2
    assert capsys.readouterr().err == f"error: {error}\n"
    assert not (tmp_path / "out").exists()


def test_the_directory_of_a_sweep_takes_no_other_stimuli(tmp_path, pictures, capsys) -> None:
    write_sweep(tmp_path / "sweep.yaml", pictures, {"seed": [1, 2]})
    assert main([str(tmp_path), "--stimuli", str(pictures)]) == 2
    expected = f"error: {tmp_path}: expected no --out and no --stimuli: it has its own\n"
    assert capsys.readouterr().err == expected


@pytest.mark.parametrize(
    ("make", "error"),
    [
        (lambda d: (d / "sweep.yaml").write_text("axes: {seed: [7]}"), "it contains another"),
        (lambda d: (d / "notes.txt").write_text("mine"), "it is not empty"),
    ],
)
def test_a_directory_that_holds_something_else_is_refused(tmp_path, pictures, capsys, make, error):
    sweep = write_sweep(tmp_path / "small.yaml", pictures, {"seed": [1, 2]})
    out = tmp_path / "out"
    out.mkdir()
    make(out)
    before = {path: path.read_bytes() for path in out.iterdir()}
    assert main([str(sweep), "--out", str(out)]) == 2
    said = capsys.readouterr().err
    assert said.startswith("error: ")
    assert error in said
    assert {path: path.read_bytes() for path in out.iterdir()} == before


def test_a_run_that_cannot_be_keeps_all_from_starting(tmp_path, pictures, capsys) -> None:
    path = write_sweep(tmp_path / "bad.yaml", pictures, {"vergence_rl.cacla.discount": [0.3, 2.0]})
    assert main([str(path), "--out", str(tmp_path / "sweep")]) == 2
    assert capsys.readouterr().err.startswith("error: discount_2.0: ")
    assert not (tmp_path / "sweep").exists()


@pytest.mark.parametrize(
    ("edit", "error"),
    [
        ({"iterations": 400}, "iterations: the run to be resumed, DIR, has"),
        ({"task.n_bases": 16}, "task.n_bases: the run to be resumed, DIR"),
    ],
)
def test_what_a_run_has_begun_with_cannot_be_edited(tmp_path, pictures, capsys, edit, error):
    sweep = write_sweep(tmp_path / "sweep.yaml", pictures, {"seed": [1, 2]})
    (name, request), _ = read_sweep(sweep).runs().items()
    begun = tmp_path / name
    begun.mkdir()
    (begun / "config.yaml").write_text(configuration_text(configuration_of(request, "")))
    write_sweep(sweep, pictures, {"seed": [1, 2]}, **edit)
    assert main([str(tmp_path)]) == 2
    assert error.replace("DIR", str(begun)) in capsys.readouterr().err
    assert sorted(path.name for path in tmp_path.iterdir()) == [begun.name, "sweep.yaml"]
