"""config.yaml of earlier versions."""

from pathlib import Path

import pytest
import yaml

from experiment_manager.run.config_file import read_configuration
from lockstep.errors import InputError

ROOT = Path(__file__).parents[3]


@pytest.mark.parametrize("config", sorted((ROOT / "results").rglob("config.yaml")), ids=str)
def test_the_committed_runs_can_be_read(config: Path) -> None:
    configuration = read_configuration(config)
    n_iterations = configuration["experiment_manager"]["protocol.n_training_iterations"]
    assert configuration["sparse_coder"]["n_training_iterations"] == n_iterations
    assert configuration["vergence_rl"]["n_training_iterations"] == n_iterations


@pytest.mark.parametrize(("share", "is_read"), [(0.0, True), (0.2, False)])
def test_what_is_gone_is_left_out_where_it_did_nothing(tmp_path, share, is_read):
    old = ROOT / "results/paper/seed_1-model_M/config.yaml"
    document = yaml.safe_load(old.read_text())
    document["/**/vergence_rl"]["ros__parameters"]["wide_exploration_share"] = share
    path = tmp_path / "config.yaml"
    path.write_text(yaml.safe_dump(document))
    if is_read:
        assert read_configuration(path) == read_configuration(old)
    else:
        with pytest.raises(InputError, match="unknown parameter wide_exploration_share"):
            read_configuration(path)
