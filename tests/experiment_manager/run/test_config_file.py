"""config.yaml of the runs behind results/."""

from pathlib import Path

import pytest

from experiment_manager.run.config_file import read_configuration

ROOT = Path(__file__).parents[3]


@pytest.mark.parametrize("config", sorted((ROOT / "results").rglob("config.yaml")), ids=str)
def test_the_committed_runs_can_be_read(config: Path) -> None:
    configuration = read_configuration(config)
    n_iterations = configuration["experiment_manager"]["protocol.n_training_iterations"]
    assert configuration["sparse_coder"]["n_training_iterations"] == n_iterations
    assert configuration["vergence_rl"]["n_training_iterations"] == n_iterations
