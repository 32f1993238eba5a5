"""Eyes whose muscles have commands of their own: a graph records what the loop computes."""

import numpy as np
import pytest

from experiment_manager import Bag
from experiment_manager.measures.results import RESULTS_FILE, read_results
from lockstep import ALL_MUSCLES, COMMAND_SPACES
from lockstep.wire.topics import TEST
from tests.kept_tests import kept_tests
from tests.loop_contract import assert_as_the_loop, run_line
from tests.supervised_run import interrupted_and_resumed

pytestmark = pytest.mark.graph


def test_eyes_that_make_saccades_are_recorded_as_the_loop_has_them(pictures, tmp_path) -> None:
    directory = tmp_path / "run"
    line = run_line(
        pictures,
        "experiment_manager.n_starts_per_distance=4",
        "experiment_manager.gives_targets=false",
        "eyes.mechanics.parameter_set=anatomical",
        "eyes.mechanics.moves=at_once",
        "eyes.noise.turn_sd_deg=0.1",
        f"task.command_space={ALL_MUSCLES}",
        "task.lowest_activations=[0.01]",
        "task.highest_activations=[0.2]",
        "task.metabolic_cost_weight=0.3",
        "task.price_rise_share=0.75",
        "task.fixation_iterations=5",
        "vergence_rl.products_of_activations=true",
        "vergence_rl.hindsight.n_best=2",
        rule="hindsight",
    )
    interrupted_and_resumed(line, directory, begins_in_process=True)
    assert_as_the_loop(directory)
    command = Bag(directory / "bag").vectors("muscle_command")["muscle_command"]
    for name in COMMAND_SPACES[ALL_MUSCLES].names:
        assert (command.column(name) >= 0.01).all()
    gaze, truth = Bag(directory / "bag").vectors("gaze", "ground_truth").values()
    # In tests the protocol gives the targets, in training the eyes choose among patches.
    chosen = gaze.column("target_sideways_deg")
    assert np.isfinite(chosen[::5]).all()
    in_test = truth.column("phase") == TEST
    assert (truth.column("target_sideways_deg")[in_test] != 0.0).all()
    assert not truth.column("target_sideways_deg")[~in_test].any()
    # From the second change on the left eye is covered, so that its movements are not seen.
    turns_deg = gaze.column("left_up_deg")[1::5]
    assert np.isfinite(turns_deg[0])
    assert np.isnan(turns_deg[-1])
    (summary, *_) = read_results(directory / RESULTS_FILE).tests
    assert summary.saccade_error_deg["after_2"].median > 0.0
    kept = kept_tests(directory)[-1]
    assert kept.activations.shape[-1] == 12
    assert np.isfinite(kept.column("cyclovergence_error_deg")[:, -1]).all()
