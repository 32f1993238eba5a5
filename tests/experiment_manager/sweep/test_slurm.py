"""What sbatch is told."""

from pathlib import Path

from experiment_manager.sweep import slurm


def test_a_percent_sign_of_a_directory_is_no_pattern(tmp_path: Path, monkeypatch) -> None:
    told: list[str] = []
    monkeypatch.setattr(slurm, "_sbatch", lambda options: told.extend(options) or "7")
    directory = tmp_path / "50%jitter #1"
    directory.mkdir()
    assert slurm.submit(directory, "0,1", ("sweep", "x"), ()) == "7"
    assert f"--output={tmp_path}/50%%jitter #1/logs/slurm_%a.out" in told
    assert f"--chdir={directory}" in told
