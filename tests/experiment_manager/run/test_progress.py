"""What a run counts up, and that a checkpoint carries all of it."""

import msgspec
import numpy as np
import pytest

from experiment_manager import Summary
from experiment_manager.measures.criteria import criteria_of
from experiment_manager.measures.kept_trials import arrays_of
from experiment_manager.measures.trials import TrialTable, trial_names
from experiment_manager.run.progress import Progress, ProgressState
from eye_plant.config import EyePlantConfig
from lockstep.errors import InputError
from lockstep.wire.topics import GROUND_TRUTH_NAMES, TEST, TRAINING
from tests.pair import PAIR_SPACE

ACTIVATIONS = np.array([0.1, 0.02, 0.1, 0.02])


def _truth(**values: float) -> np.ndarray:
    assert set(values) <= set(GROUND_TRUTH_NAMES)
    return np.array([values.get(name, 0.0) for name in GROUND_TRUTH_NAMES])


CRITERIA = criteria_of(EyePlantConfig())


def _reward(coarse: float, fine: float, cost_w: float) -> np.ndarray:
    """Return the values of reward_names."""
    return np.array([coarse, fine, cost_w, 0.0, 0.0, 0.0])


def _trial(trial: int, errors_deg: list[float]) -> list[np.ndarray]:
    return [
        _truth(
            phase=TEST,
            trial=trial,
            iteration=i,
            training_iteration=500,
            vergence_error_deg=error_deg,
            metabolic_rate_w=2.0 if i == 0 else 1.0,
            initial_metabolic_rate_w=2.0,
            optimal_metabolic_rate_w=1.0,
        )
        for i, error_deg in enumerate(errors_deg)
    ]


def _add_test(progress: Progress, finals_deg: list[float]) -> Summary:
    for trial, final_deg in enumerate(finals_deg):
        rows = _trial(trial, [-1.0] * 20 + [final_deg])
        for i, row in enumerate(rows):
            progress.add_truth(row, is_last=i == 20)
            progress.add_activations(TEST, ACTIVATIONS)
    return progress.end_test(20, CRITERIA)


def test_a_test_is_summed_up_after_iteration_20() -> None:
    summary = _add_test(Progress(1000, PAIR_SPACE), [0.1, -0.2, 0.3, -0.4, 0.5])
    assert summary.iteration == 500
    assert summary.n_trials == 5
    assert summary.median_abs_vergence_error_deg == pytest.approx(0.3)
    assert summary.iqr_abs_vergence_error_deg == pytest.approx(0.2)
    assert summary.median_cost_reduction == pytest.approx(1.0)


def test_each_test_starts_from_nothing() -> None:
    progress = Progress(1000, PAIR_SPACE)
    _add_test(progress, [5.0, 5.0, 5.0])
    assert _add_test(progress, [0.1]).median_abs_vergence_error_deg == pytest.approx(0.1)
    assert len(progress.tests) == 2


def test_the_running_error_is_of_the_last_observations_of_training() -> None:
    progress = Progress(1000, PAIR_SPACE)
    assert progress.running_median_error_deg is None
    for error_deg in (-1.0, 2.0, -9.0):
        progress.add_truth(_truth(phase=TRAINING, vergence_error_deg=50.0), is_last=False)
        progress.add_truth(_truth(phase=TRAINING, vergence_error_deg=error_deg), is_last=True)
    assert progress.running_median_error_deg == 2.0


def test_the_running_error_forgets() -> None:
    progress = Progress(10**6, PAIR_SPACE)
    for error_deg in [7.0] * 300 + [1.0] * 200:
        progress.add_truth(_truth(phase=TRAINING, vergence_error_deg=error_deg), is_last=True)
    assert progress.running_median_error_deg == 1.0


def test_cost_share_of_the_first_and_the_last_iterations() -> None:
    progress = Progress(20_000, PAIR_SPACE)
    progress.add_reward(TRAINING, 0, _reward(0.2, 0.2, 1.0))
    progress.add_reward(TRAINING, 4999, _reward(0.1, 0.3, 3.0))
    progress.add_reward(TRAINING, 5000, _reward(100.0, 100.0, 100.0))
    progress.add_reward(TRAINING, 14_999, _reward(100.0, 100.0, 100.0))
    progress.add_reward(TEST, 15_000, _reward(100.0, 100.0, 100.0))
    progress.add_reward(TRAINING, 15_000, _reward(0.05, 0.05, 1.0))
    # lambda C / (E + lambda C): first 0.1 * 4 / (0.8 + 0.4), last 0.1 / (0.1 + 0.1).
    assert progress.cost_share("first", 0.1) == pytest.approx(0.4 / 1.2)
    assert progress.cost_share("last", 0.1) == pytest.approx(0.5)
    assert progress.cost_share("first", 0.0) == 0.0


def test_a_share_of_nothing_is_none() -> None:
    progress = Progress(100, PAIR_SPACE)
    progress.add_reward(TRAINING, 0, _reward(0.0, 0.0, 0.0))
    assert progress.cost_share("first", 0.1) is None


def test_a_checkpoint_during_a_test_carries_everything() -> None:
    draw = np.random.default_rng(1)
    undisturbed = Progress(100, PAIR_SPACE)
    _add_test(undisturbed, [0.3, 0.1])
    for i in range(50):
        undisturbed.add_truth(
            _truth(phase=TRAINING, vergence_error_deg=float(draw.normal())), is_last=True
        )
        undisturbed.add_reward(TRAINING, i, _reward(*draw.random(3)))
    for row in _trial(0, list(draw.normal(size=21))):
        undisturbed.add_truth(row, is_last=False)
        undisturbed.add_activations(TEST, draw.random(4) / 100)

    resumed = Progress(100, PAIR_SPACE)
    written = msgspec.json.encode(undisturbed.state())
    resumed.restore(
        msgspec.json.decode(written, type=ProgressState),
        undisturbed.trial_table(),
        undisturbed.kept_trials,
    )
    ends = []
    for progress in (undisturbed, resumed):
        for row in _trial(1, [0.1 / 3] * 21):
            progress.add_truth(row, is_last=False)
            progress.add_activations(TEST, ACTIVATIONS)
        progress.add_reward(TRAINING, 51, _reward(0.1, 0.2, 0.3))
        progress.end_test(20, CRITERIA)
        ends.append(
            (
                progress.tests,
                progress.cost_share("first", 0.07),
                progress.cost_share("last", 0.07),
                progress.running_median_error_deg,
                {name: array.tolist() for name, array in arrays_of(progress.kept_trials).items()},
            )
        )
    assert ends[0] == ends[1]
    assert ends[0][-1]["training_iteration"] == [500, 500]
    assert len(ends[0][0]) == 2


def test_restoring_does_not_share_what_it_restores_from() -> None:
    first = Progress(100, PAIR_SPACE)
    first.add_reward(TRAINING, 0, _reward(0.1, 0.1, 1.0))
    state = first.state()
    second = Progress(100, PAIR_SPACE)
    second.restore(state, first.trial_table())
    before = msgspec.json.encode(state)
    second.add_reward(TRAINING, 1, _reward(0.5, 0.1, 1.0))
    second.add_truth(_truth(phase=TRAINING, vergence_error_deg=1.0), is_last=True)
    assert msgspec.json.encode(state) == before


def test_activations_come_before_or_after_their_ground_truth() -> None:
    progress = Progress(0, PAIR_SPACE)
    before, after = _trial(0, [-1.0, 0.5])
    progress.add_activations(TEST, np.array([0.1, 0.0, 0.3, 0.2]))
    progress.add_truth(before, is_last=False)
    progress.add_truth(after, is_last=True)
    with pytest.raises(InputError, match=r"expected activations of 2 observations.*those of 1"):
        progress.trial_table()
    progress.add_activations(TRAINING, ACTIVATIONS)
    progress.add_activations(TEST, np.array([0.5, 0.6, 0.5, 0.6]))
    rows = progress.trial_table().rows
    assert rows[:, -2:] == pytest.approx(np.array([[0.2, 0.1], [0.5, 0.6]]))
    assert (rows[:, :-2] == [before, after]).all()


def test_saved_trials_with_other_columns_are_refused_where_there_are_some() -> None:
    fewer = np.zeros((3, len(GROUND_TRUTH_NAMES)))
    with pytest.raises(
        InputError, match=r"expected rows of \d+ numbers, got an array of shape \(3, \d+\)"
    ):
        TrialTable.saved(fewer, PAIR_SPACE)
    assert TrialTable.saved(fewer[:0], PAIR_SPACE).rows.shape == (0, len(trial_names(PAIR_SPACE)))
