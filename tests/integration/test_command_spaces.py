"""Eyes whose muscles have commands of their own: a graph records what the loop computes."""

from pathlib import Path

import numpy as np
import pytest

from experiment_manager import Bag
from experiment_manager.measures.results import RESULTS_FILE, read_results
from lockstep import ALL_MUSCLES, COMMAND_SPACES, HORIZONTAL_RECTI
from lockstep.wire.topics import TEST
from tests.kept_tests import kept_tests
from tests.loop_contract import assert_as_the_loop, run_line
from tests.supervised_run import SupervisedRun, interrupted_and_resumed

pytestmark = pytest.mark.graph


def _with_own_commands(
    pictures: Path, directory: Path, *settings: str, is_interrupted: bool = False
) -> Path:
    """Make a run whose muscles have commands of their own, and check it against the loop."""
    line = run_line(
        pictures,
        "experiment_manager.n_starts_per_distance=4",
        "eyes.mechanics.parameter_set=anatomical",
        "eyes.mechanics.moves=at_once",
        *settings,
        rule="hindsight",
    )
    if is_interrupted:
        interrupted_and_resumed(line, directory, begins_in_process=True)
    else:
        with SupervisedRun(line, directory) as run:
            assert run.wait() == 0, run.output()
    assert_as_the_loop(directory)
    return directory


def test_muscles_with_commands_of_their_own_are_recorded_as_the_loop_has_them(
    pictures, tmp_path
) -> None:
    settings = (
        f"task.command_space={HORIZONTAL_RECTI}",
        "task.lowest_activations=[0.01]",
        "task.highest_activations=[0.2]",
        "vergence_rl.hindsight.n_best=3",
        "task.price_rise_share=0.75",
    )
    directory = _with_own_commands(pictures, tmp_path / "run", *settings)
    command = Bag(directory / "bag").vectors("muscle_command")["muscle_command"]
    for name in COMMAND_SPACES[HORIZONTAL_RECTI].names:
        assert (command.column(name) >= 0.01).all()
    assert kept_tests(directory)[-1].activations.shape[-1] == 4


_TWELVE = (
    f"task.command_space={ALL_MUSCLES}",
    "task.lowest_activations=[0.0]",
    "task.highest_activations=[0.2]",
    "task.metabolic_cost_weight=0.3",
)


def test_eyes_that_make_saccades_are_recorded_as_the_loop_has_them(pictures, tmp_path) -> None:
    settings = (
        "task.fixation_iterations=5",
        "vergence_rl.products_of_activations=true",
        "vergence_rl.hindsight.n_best=2",
        "experiment_manager.gives_targets=false",
        "experiment_manager.tonic_return=0.1",
        "eyes.noise.turn_sd_deg=0.1",
    )
    line = *_TWELVE, *settings
    directory = _with_own_commands(pictures, tmp_path / "run", *line, is_interrupted=True)
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


def test_vergence_by_turns_without_saccades_is_recorded_as_the_loop_has_it(
    pictures, tmp_path
) -> None:
    turns = "task.measures_turns=true"
    directory = _with_own_commands(pictures, tmp_path / "run", *_TWELVE, turns)
    (gaze,) = Bag(directory / "bag").vectors("gaze").values()
    assert np.isnan(gaze.column("target_up_deg")).all()
    # Before they have learned, the eyes do not move in a test.
    for name in ("left_up_deg", "right_up_deg"):
        assert gaze.column(name)[[1, 6]] == pytest.approx(0.0, abs=1e-3)
        assert np.isnan(gaze.column(name)[[0, 2]]).all()
