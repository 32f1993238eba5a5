"""The measures, by hand."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from msgspec import to_builtins

from experiment_manager import Criteria, Summary
from experiment_manager.measures import metrics
from experiment_manager.measures.metrics import cost_share
from experiment_manager.measures.results import ActivePairs
from experiment_manager.measures.trials import (
    Trials,
    TrialTable,
    only_test,
    pooled,
    split_tests,
    trial_names,
)
from lockstep import InputError
from lockstep.wire.topics import TEST, TRAINING
from tests.experiment_manager.summaries import NO_TRIALS
from tests.pair import PAIR_SPACE

CRITERIA = Criteria(
    px_deg=0.22264,
    silent_activation=0.005,
    lateral_is_silent_up_to_m=2.0,
    medial_is_silent_from_m=4.0,
    lowest_activations=(0.0, 0.0),
)
TRIAL_NAMES = trial_names(PAIR_SPACE)
INDEX = {name: i for i, name in enumerate(TRIAL_NAMES)}


def summary_of(rows: np.ndarray, criteria: Criteria = CRITERIA) -> Summary:
    """Return the summary of rows whose longest trial is whole."""
    n_iterations = int(rows[:, INDEX["iteration"]].max()) if rows.ndim == 2 else 0
    return metrics.summary_of(only_test(TrialTable(rows, PAIR_SPACE), n_iterations), criteria)


def _tests(rows: list[list[float]], n_iterations: int) -> list[Trials]:
    return split_tests(TrialTable(np.array(rows), PAIR_SPACE), n_iterations)


def _row(**values: float) -> list[float]:
    row = [0.0] * len(TRIAL_NAMES)
    for name, value in values.items():
        row[INDEX[name]] = value
    return row


def _trial(
    errors_deg: list[float], costs_w: list[float], optimal_w: float = 0.5, **values: float
) -> list[list[float]]:
    """Rows of one trial: errors and costs at iterations 0, 1, ..."""
    common: dict[str, Any] = {"phase": TEST, "training_iteration": 500, **values}
    return [
        _row(
            iteration=i,
            vergence_error_deg=error_deg,
            metabolic_rate_w=cost_w,
            optimal_metabolic_rate_w=optimal_w,
            initial_metabolic_rate_w=costs_w[0],
            **common,
        )
        for i, (error_deg, cost_w) in enumerate(zip(errors_deg, costs_w, strict=True))
    ]


def _five_trials() -> np.ndarray:
    rows: list[list[float]] = []
    # start error, error after 1, after 2; start cost, cost after 1, after 2
    for trial, (errors_deg, costs_w) in enumerate(
        (
            ([2.0, -0.8, 0.1], [1.5, 1.0, 0.5]),  # c: 0.5, then 1.0
            ([-1.0, 0.4, -0.3], [1.5, 1.5, 1.4]),  # c: 0.0, then 0.1
            ([0.0, 0.0, 0.2], [0.5, 0.6, 0.7]),  # c undefined: it starts at the optimum
            ([1.0, 1.2, 0.6], [2.5, 2.0, 2.5]),  # c: 0.25, then 0.0
            ([-3.0, -2.0, 1.0], [1.0, 0.6, 0.4]),  # c: 0.8, then 1.2
        )
    ):
        rows += _trial(errors_deg, costs_w, trial=trial, stimulus=trial + 100)
    return np.array(rows)


def test_a_summary_by_hand() -> None:
    result = summary_of(_five_trials())
    # After the last iteration |error| is .1 .2 .3 .6 1.0, C - C* is 0 .9 .2 2. -.1.
    assert result.iteration == 500
    assert result.n_trials == 5
    assert result.median_abs_vergence_error_deg == pytest.approx(0.3)
    assert result.iqr_abs_vergence_error_deg == pytest.approx(0.6 - 0.2)
    assert result.median_delta_cost_w == pytest.approx(0.2)
    # c of the four trials where it is defined: 1.0 0.1 0.0 1.2
    assert result.median_cost_reduction == pytest.approx(0.55)
    # After 1: |error| .8 .4 .0 1.2 2.; C - C* .5 1. .1 1.5 .1; c .5 0 .25 .8
    assert to_builtins(result.after[1]) == {
        "median_abs_vergence_error_deg": pytest.approx(0.8),
        "iqr_abs_vergence_error_deg": pytest.approx(0.8),
        "median_delta_cost_w": pytest.approx(0.5),
        "median_cost_reduction": pytest.approx(0.375),
        "share_within_1_px": pytest.approx(1 / 5),
        "share_beyond_1_deg": pytest.approx(2 / 5),
        "share_antagonist_silent": pytest.approx(1.0),
    }
    # All activations are 0.
    assert result.antagonists_active == ActivePairs(0.0, 0.0, 1.0)
    assert 2 not in result.after, "two iterations is the end, at the top level already"


def test_a_saving_is_told_of_eyes_that_verge() -> None:
    result = summary_of(_five_trials())
    # C / C* is 1 2.8 1.4 5 .8.
    assert result.median_cost_ratio == pytest.approx(1.4)
    # Two of five trials end within one pixel.
    assert result.share_within_1_px == pytest.approx(0.4)
    assert result.saving is None
    verging = summary_of(_five_trials()[:9])
    assert verging.saving == verging.median_cost_reduction == pytest.approx(0.55)


def test_a_saving_is_that_at_the_target_of_then() -> None:
    rows = np.array(_trial([1.0, 0.5, 0.1], [1.5, 1.0, 1.0], trial=0))
    # The second target is harder to hold.
    rows[2, INDEX["optimal_metabolic_rate_w"]] = 0.9
    result = summary_of(rows)
    assert result.median_delta_cost_w == pytest.approx(0.1)
    assert result.median_cost_reduction == pytest.approx(0.5 / 0.6)
    assert result.after[1].median_delta_cost_w == pytest.approx(0.5)
    rows[2, INDEX["optimal_metabolic_rate_w"]] = np.nan
    assert summary_of(rows).median_delta_cost_w is None


def test_a_summary_without_zero_start_errors_by_hand() -> None:
    result = summary_of(_five_trials()).without_zero_start_error
    # .1 .3 .6 1.0 remain; 0 .9 2. -.1
    assert result.n_trials == 4
    assert result.median_abs_vergence_error_deg == pytest.approx(0.45)
    assert result.iqr_abs_vergence_error_deg == pytest.approx(0.7 - 0.25)
    assert result.median_delta_cost_w == pytest.approx(0.45)
    assert result.median_cost_reduction == pytest.approx(0.55)
    assert result.after[1].median_abs_vergence_error_deg == pytest.approx(1.0)


def test_after_1_2_3_are_told_of_long_trials() -> None:
    errors_deg = [1.0 / (i + 1) for i in range(21)]
    rows = _trial(errors_deg, [1.0] * 21, trial=0)
    result = summary_of(np.array(rows))
    assert [result.after[k].median_abs_vergence_error_deg for k in (1, 2, 3)] == (
        pytest.approx([1 / 2, 1 / 3, 1 / 4])
    )
    assert result.median_abs_vergence_error_deg == pytest.approx(1 / 21)
    assert list(result.after) == [1, 2, 3]


def test_measures_without_any_trial_are_none() -> None:
    result = summary_of(np.array(_trial([0.0, 0.1], [0.5, 0.6], trial=0)))
    assert result.n_trials == 1
    assert result.median_cost_reduction is None, "the only trial starts at the optimum"
    assert result.without_zero_start_error == NO_TRIALS
    assert result.starts_up_to_2_deg == NO_TRIALS


def test_each_eye_by_hand() -> None:
    rows = [
        _row(
            phase=TEST,
            trial=trial,
            iteration=iteration,
            version_deg=9.0 if iteration == 0 else version_deg,
            left_deviation_deg=9.0 if iteration == 0 else left_deg,
            right_deviation_deg=right_deg,
        )
        for trial, (version_deg, left_deg, right_deg) in enumerate(
            [(1.0, 2.0, 0.0), (-3.0, -3.0, 3.0), (0.5, 1.0, 0.0)]
        )
        for iteration in (0, 1)
    ]
    result = summary_of(np.array(rows))
    assert result.median_abs_version_deg == pytest.approx(1.0)
    assert result.median_left_deviation_deg == pytest.approx(1.0)
    assert result.median_right_deviation_deg == pytest.approx(0.0)


def test_shares_of_errors_by_hand() -> None:
    finals_deg = [0.0, 0.2226, -0.2227, 0.99, 1.0, -1.01, 7.0]
    rows = [_trial([-1.0, e], [1.0, 1.0], trial=i) for i, e in enumerate(finals_deg)]
    result = summary_of(np.concatenate(rows))
    assert result.share_within_1_px == pytest.approx(2 / 7)
    assert result.share_beyond_1_deg == pytest.approx(2 / 7), "1 deg itself is not beyond it"


def _ended(ends: Sequence[Sequence[float]]) -> np.ndarray:
    """Rows of trials that end with (distance, medial, lateral) or (..., error in deg)."""
    rows: list[list[float]] = []
    for trial, (distance_m, medial, lateral, *error_deg) in enumerate(ends):
        muscles = {"medial_rectus": medial, "lateral_rectus": lateral}
        errors_deg = [-1.0, *(error_deg or [0.0])]
        rows += _trial(errors_deg, [1.0, 1.0], trial=trial, object_distance_m=distance_m, **muscles)
    return np.array(rows)


def test_the_antagonist_is_the_lateral_one_near_and_the_medial_one_far() -> None:
    # distance, medial, lateral after the trial; a muscle is silent below 0.005
    ends = [
        (0.5, 0.07, 0.0049),  # silent as it should be
        (2.0, 0.0, 0.005),  # the wrong one is silent
        (3.0, 0.0, 0.0),  # either may be: does not count
        (3.9, 0.0, 0.0),
        (4.0, 0.0, 0.003),  # silent as it should be
        (6.0, 0.004, 0.3),  # silent as it should be
        (6.0, 0.2, 0.0),  # the wrong one is silent
    ]
    assert summary_of(_ended(ends)).share_antagonist_silent == pytest.approx(3 / 5)
    assert summary_of(_ended(ends[2:3])).share_antagonist_silent is None
    unknown = _ended(ends)
    unknown[:2, INDEX["lateral_rectus"]] = np.nan
    assert summary_of(unknown).share_antagonist_silent == pytest.approx(2 / 4)


def test_bias_by_distance_by_hand() -> None:
    finals_deg = {0.5: [0.3, 0.5, -0.1], 6.0: [-0.2, -0.1]}
    rows: list[list[float]] = []
    for distance_m, ends_deg in finals_deg.items():
        for end_deg in ends_deg:
            n = len(rows) // 2
            rows += _trial([1.0, end_deg], [1.0, 1.0], trial=n, object_distance_m=distance_m)
    found = summary_of(np.array(rows)).bias_by_distance_deg
    assert found == {"0.5": pytest.approx(0.3), "6": pytest.approx(-0.15)}


def test_small_start_errors_are_whole_degrees_up_to_2_without_0() -> None:
    # The eyes settle within 0.02 deg of the whole degree that was asked for.
    starts_deg = [-3.01, -1.98, -1.0, 0.0, 0.01, 1.02, 1.99, 3.0, 6.0, 4 / 3]
    rows = [_trial([e, e / 10], [1.0, 0.8], trial=i) for i, e in enumerate(starts_deg)]
    result = summary_of(np.concatenate(rows))
    small = result.starts_up_to_2_deg
    assert small.n_trials == 5
    assert small.median_abs_vergence_error_deg == pytest.approx(0.198)


def test_pooled_trials_are_those_of_all_runs() -> None:
    (one,) = _tests(_trial([1.0, 0.5], [1.0, 1.0]), 1)
    (other,) = _tests(_trial([2.0, 0.1], [1.0, 2.0]), 1)
    both = pooled([one, other])
    assert both.vergence_error_deg.tolist() == [[1.0, 0.5], [2.0, 0.1]]
    assert both.training_iteration == 500
    assert metrics.summary_of(both, CRITERIA).n_trials == 2


def test_tests_are_split_and_training_is_ignored() -> None:
    training = [_row(phase=TRAINING, test=-1, trial=-1, iteration=i) for i in range(11)]
    first = _trial([1.0, 0.5], [1.0, 1.0], test=0, trial=0, training_iteration=0)
    second = _trial([1.0, 0.2], [1.0, 1.0], test=1, trial=0, training_iteration=50_000)
    tests = _tests(training + first + training + training + second, 1)
    assert [test.training_iteration for test in tests] == [0, 50_000]
    assert [float(test.vergence_error_deg[0, 1]) for test in tests] == [0.5, 0.2]
    assert tests[1].rows.tolist() == [[35, 36]]


def test_broken_trials_are_left_out_and_the_last_repetition_counts() -> None:
    whole = [_trial([1.0, e, e], [1.0] * 3, trial=t) for t, e in ((0, 0.1), (1, 0.2), (2, 0.3))]
    again = _trial([1.0, 0.7, 0.9], [1.0] * 3, trial=1)
    rows = whole[0] + whole[1][:2] + again + whole[2][:1] + whole[2] + whole[0][:2]
    (trials,) = _tests(rows, 2)
    assert trials.trial.tolist() == [0, 1, 2]
    assert trials.vergence_error_deg[:, 2].tolist() == [0.1, 0.9, 0.3]
    assert metrics.summary_of(trials, CRITERIA).n_trials == 3


def test_of_a_test_that_ended_in_its_first_trial_nothing_counts() -> None:
    part = _trial([1.0, 0.5, 0.3], [1.0] * 3)
    assert len(_tests(part, 2)) == 1
    assert _tests(part, 20) == []
    with pytest.raises(InputError, match="expected the rows of one test, got those of 0"):
        only_test(TrialTable(np.array(part), PAIR_SPACE), 20)


def test_what_counts_is_that_of_the_runs_own_eyes_and_cameras() -> None:
    # Twice the pixels per degree, a higher floor, eyes that rest on something nearer.
    other = Criteria(0.11132, 0.01, 0.5, 1.0, (0.0, 0.0))
    rows = _ended([(0.5, 0.07, 0.009, 0.2), (2.0, 0.009, 0.1, 0.1)])
    ours, theirs = (summary_of(rows, criteria) for criteria in (CRITERIA, other))
    assert (ours.share_within_1_px, theirs.share_within_1_px) == (1.0, 0.5)
    assert ours.share_antagonist_silent == 0.0
    assert theirs.share_antagonist_silent == 1.0


def test_one_test_is_expected() -> None:
    one = _trial([1.0, 0.5], [1.0, 1.0], test=0)
    two = one + _trial([1.0, 0.5], [1.0, 1.0], test=1)
    with pytest.raises(InputError, match="expected the rows of one test, got those of 2"):
        summary_of(np.array(two))
    with pytest.raises(InputError, match="expected the rows of one test, got those of 0"):
        summary_of(np.array(one)[1:])
    with pytest.raises(InputError, match=r"expected rows of \d+ numbers, got .*\(3,\)"):
        summary_of(np.zeros(3))


def test_the_share_of_the_cost_by_hand() -> None:
    # E = 0.4 + 0.2, C = 1 + 2, lambda = 0.05: 0.15 / (0.6 + 0.15)
    assert cost_share(0.4 + 0.2, 1.0 + 2.0, 0.05) == pytest.approx(0.2)
    assert cost_share(0.4, 1.0, 0.0) == 0.0
    assert cost_share(0.0, 0.0, 0.05) is None
