"""Learning that runs away ends the run with one error, and leaves what was saved before whole."""

import re

import numpy as np
import pytest

from experiment_manager import Bag
from tests.graph_harness import small_run
from tests.supervised_run import SupervisedRun, is_intact

pytestmark = pytest.mark.graph

SETTINGS = (
    "experiment_manager.checkpoint_period_s=1e9",  # the first one alone, at the start
    "task.n_bases=32",
    "vergence_rl.cacla.critic_learning_rate=1e6",
    "vergence_rl.cacla.critic_step_limit=1e9",
)


@pytest.mark.parametrize("in_process", [False, True])
def test_divergence_ends_the_run_with_one_error(pictures, tmp_path, in_process) -> None:
    directory = tmp_path / "run"
    with SupervisedRun(
        small_run(pictures, 400, *SETTINGS), directory, in_process=in_process
    ) as run:
        assert run.wait() == 3, run.output()
        output = run.output()
    assert output.count("error: ") == 1
    # On a line of its own, not behind the progress bar.
    error = re.search(r"^error: vergence_rl diverged in training iteration (\d+)", output, re.M)
    assert error is not None
    assert "expected 100 at most; what was saved before is intact" in output
    assert "fault: " not in output
    assert "--resume" not in output  # it would diverge again
    assert is_intact(directory)
    bag = Bag(directory / "bag")
    assert all(file.complete for file in bag.files)
    truth, critic = bag.vectors("ground_truth", "actor_critic").values()
    assert np.abs(critic.column("value")).max() <= 100.0
    # All up to the failure, which is many episodes behind the only checkpoint.
    assert abs(truth.column("training_iteration")[-1] - int(error[1])) <= 1
