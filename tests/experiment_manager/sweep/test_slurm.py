"""What sbatch is told."""

from collections.abc import Sequence
from pathlib import Path

from experiment_manager.sweep import slurm


def test_a_percent_sign_of_a_directory_is_no_pattern(tmp_path: Path, monkeypatch) -> None:
    def sbatch(options: Sequence[str]) -> str:
        assert f"--output={tmp_path}/50%%jitter #1/logs/slurm_%a.out" in options
        assert f"--chdir={directory}" in options
        return "7;cluster\n"

    monkeypatch.setattr(slurm, "_sbatch", sbatch)
    directory = tmp_path / "50%jitter #1"
    directory.mkdir()
    assert slurm.submit(directory, "0,1", ("sweep", "x"), ()) == "7"
