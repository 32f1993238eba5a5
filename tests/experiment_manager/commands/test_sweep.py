"""What sweep.sh refuses before it does anything."""

from pathlib import Path

import pytest

from experiment_manager.commands.sweep import main
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
    pictures: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    *,
    words: list[str],
    error: str,
) -> None:
    monkeypatch.setenv("PATH", "")
    sweep = write_sweep(tmp_path / "small.yaml", pictures, {"seed": [1, 2]})
    assert main([str(sweep), "--out", str(tmp_path / "out"), *words]) == 2
    assert capsys.readouterr().err == f"error: {error}\n"
    assert not (tmp_path / "out").exists()


def test_the_directory_of_a_sweep_takes_no_other_stimuli(
    tmp_path: Path, pictures: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_sweep(tmp_path / "sweep.yaml", pictures, {"seed": [1, 2]})
    assert main([str(tmp_path), "--stimuli", str(pictures)]) == 2
    expected = f"error: {tmp_path}: expected no --out and no --stimuli: it has its own\n"
    assert capsys.readouterr().err == expected
