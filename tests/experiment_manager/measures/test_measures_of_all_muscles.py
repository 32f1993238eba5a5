"""What is measured where each muscle has a command of its own, by hand and through its files."""

from dataclasses import replace
from pathlib import Path

import msgspec
import numpy as np
import pytest

from experiment_manager import Criteria, Summary, summary_of
from experiment_manager.measures.antagonists import antagonist_names, reciprocity
from experiment_manager.measures.kept_trials import with_test, write_trials
from experiment_manager.measures.results import ActivePairs
from experiment_manager.measures.tables import in_words
from experiment_manager.measures.trials import Trials, TrialTable, only_test, trial_names
from experiment_manager.measures.yoked import shared_change, yoked_pairs
from lockstep import ALL_MUSCLES, COMMAND_SPACES, PAIR
from lockstep.wire.topics import TEST
from tests.kept_tests import kept_tests

SPACE = COMMAND_SPACES[ALL_MUSCLES]
NAMES = trial_names(SPACE)
# The left superior rectus has a tonic floor.
FLOORS = tuple(0.05 if name == "left_superior_rectus" else 0.0 for name in SPACE.names)
CRITERIA = Criteria(0.2, 0.0002, 2.0, 4.0, FLOORS)
ENDS = (
    {"vergence_error_deg": 0.1, "vertical_error_deg": -0.1, "cyclovergence_error_deg": 0.5},
    {"vergence_error_deg": -0.1, "vertical_error_deg": 0.3, "cyclovergence_error_deg": -1.0},
    {"vergence_error_deg": 0.3, "vertical_error_deg": 0.0, "cyclovergence_error_deg": 0.0},
    {"vergence_error_deg": 0.1, "vertical_error_deg": 0.1, "cyclovergence_error_deg": 2.0},
)
ACTIVATIONS: tuple[dict[str, float], ...] = (
    {"left_medial_rectus": 0.001, "left_superior_rectus": 0.054, "right_lateral_rectus": 0.0},
    {"left_lateral_rectus": 0.004, "left_superior_rectus": 0.056},
    {"left_inferior_rectus": 0.0},
    {},
)


def _trials() -> Trials:
    """Four trials of two iterations; what is not named is 0.08, and 9 before the last iteration."""
    rows = []
    for trial, (end, activations) in enumerate(zip(ENDS, ACTIVATIONS, strict=True)):
        for iteration in range(3):
            values = dict.fromkeys(NAMES, 0.0) | dict.fromkeys(SPACE.names, 0.08)
            values |= {"phase": TEST, "trial": trial, "iteration": iteration}
            values |= {"object_distance_m": 0.5 if trial < 2 else 2.0, "stimulus": 7 + trial // 2}
            values |= (end | activations) if iteration == 2 else dict.fromkeys(end, 9.0)
            rows.append([values[name] for name in NAMES])
    return only_test(TrialTable(np.array(rows), SPACE), 2)


def test_errors_about_all_axes_by_hand() -> None:
    result = summary_of(_trials(), CRITERIA)
    assert result.median_abs_vergence_error_deg == pytest.approx(0.1)
    assert result.median_abs_vertical_error_deg == pytest.approx(0.1)
    assert result.iqr_abs_vertical_error_deg == pytest.approx(0.15 - 0.075)
    assert result.median_abs_cyclovergence_error_deg == pytest.approx(0.75)
    assert result.iqr_abs_cyclovergence_error_deg == pytest.approx(1.25 - 0.375)
    # One is off sideways, one in height.
    assert result.share_within_1_px == pytest.approx(0.5)
    assert result.after[1].median_abs_vertical_error_deg == pytest.approx(9.0)


def test_antagonists_by_hand() -> None:
    pairs = summary_of(_trials(), CRITERIA).antagonists
    assert len(pairs) == 6
    left = pairs["left_medial_rectus-left_lateral_rectus"]
    assert left.active == ActivePairs(0.5, 0.5, 0.0)
    assert left.median_co_contraction == pytest.approx((0.004 + 0.08) / 2)
    assert left.active_by_distance == {
        "0.5": ActivePairs(0.0, 1.0, 0.0),
        "2": ActivePairs(1.0, 0.0, 0.0),
    }
    # The greater activation is 0.08 in all trials.
    assert left.reciprocity_slope is None
    # Above its floor the superior rectus is driven by 0.004 and 0.006; once the other is silent.
    vertical = pairs["left_superior_rectus-left_inferior_rectus"]
    assert vertical.active == ActivePairs(0.5, 0.5, 0.0)
    assert vertical.median_co_contraction == pytest.approx((0.004 + 0.006) / 2)
    obliques = pairs["right_superior_oblique-right_inferior_oblique"]
    assert obliques.active == ActivePairs(1.0, 0.0, 0.0)


def test_active_pairs_and_muscles_by_hand() -> None:
    test = summary_of(_trials(), CRITERIA)
    # Of 24 pairs five have a silent muscle, four of the left eye and one of the right.
    assert test.antagonists_active == ActivePairs(19 / 24, 5 / 24, 0.0)
    # 9, 11, 11 and 12 muscles.
    assert test.median_active_muscles == 11.0
    assert test.share_antagonist_silent is None


def test_eyes_that_rest_are_told_from_reciprocal_innervation() -> None:
    trials = _trials()
    names = antagonist_names(SPACE)
    limp = dict.fromkeys(SPACE.names, np.zeros((4, 3)))
    # One muscle of each pair works, as much as the trial's number.
    work = np.repeat(np.array([[0.02], [0.04], [0.06], [0.08]]), 3, axis=1)
    reciprocal = limp | {first: work for first, _ in names}
    criteria = replace(CRITERIA, lowest_activations=(0.0,) * 12)
    found = [
        summary_of(replace(trials, columns={**trials.columns, **columns}), criteria)
        for columns in (limp, reciprocal)
    ]
    assert found[0].antagonists_active == ActivePairs(0.0, 0.0, 1.0)
    assert found[1].antagonists_active == ActivePairs(0.0, 1.0, 0.0)
    assert [test.median_active_muscles for test in found] == [0.0, 6.0]
    assert "Most pairs rest then" in in_words(found[0], 0.2)
    assert "Most pairs rest then" not in in_words(found[1], 0.2)
    slopes = [{pair.reciprocity_slope for pair in test.antagonists.values()} for test in found]
    assert slopes == [{None}, {0.0}], "silence is no graded reciprocity"


@pytest.mark.parametrize("slope", [-1.0, -0.5, 0.0, 0.7])
def test_the_slope_of_the_antagonist_is_that_of_the_lesser_activation(slope: float) -> None:
    agonist = np.array([0.10, 0.12, 0.14, 0.16])
    antagonist = 0.10 + slope * (agonist - 0.10)
    # Which of both is the agonist changes with gaze; a second pair has another tonic level.
    first = np.stack([agonist, antagonist], axis=1)
    first[::2] = first[::2, ::-1]
    both = np.stack([first, first + 0.3], axis=1)
    assert reciprocity(both, 0.005).slope == pytest.approx(slope)
    assert np.isnan(reciprocity(np.zeros((4, 1, 2)), 0.005).slope)


def test_a_summary_is_read_as_it_was_written() -> None:
    result = summary_of(_trials(), CRITERIA)
    assert msgspec.json.decode(msgspec.json.encode(result), type=Summary) == result


def test_what_is_kept_has_all_axes_and_all_muscles(tmp_path: Path) -> None:
    whole = _trials()
    write_trials(tmp_path, with_test(with_test(None, whole), whole))
    for kept in kept_tests(tmp_path):
        assert kept.space == SPACE
        for name in ("vergence_error_deg", "vertical_error_deg", "cyclovergence_error_deg"):
            assert kept.column(name)[:, -1] == pytest.approx(whole.column(name)[:, -1])
    assert kept.activations[:, -1] == pytest.approx(whole.activations[:, -1])
    shares, expected = (
        [pair.active for pair in summary_of(trials, CRITERIA).antagonists.values()]
        for trials in (kept, whole)
    )
    assert shares == expected
    first, _ = kept_tests(tmp_path)
    for pair in summary_of(first, CRITERIA).antagonists.values():
        # Activations are kept of the last test only.
        assert pair.active is None
        assert set(pair.active_by_distance.values()) == {None}


def test_yoked_muscles_by_hand() -> None:
    trials = _trials()
    pairs = {pair.names: pair for pair in yoked_pairs([trials])}
    assert len(pairs) == 6
    pair = pairs["left_medial_rectus", "right_lateral_rectus"]
    # |0.001 - 0|, and three times 0; before, all activations are 0.08.
    assert pair.end_difference == pytest.approx(0.0)
    assert pair.start_difference == pytest.approx(0.0)
    # At 0.5 m both are lower in the first trial; at 2 m neither varies.
    assert pair.correlation == pytest.approx(1.0)
    upper = pairs["left_superior_rectus", "right_inferior_oblique"]
    assert upper.end_difference == pytest.approx((0.0 + 0.024) / 2)
    assert np.isnan(upper.correlation)
    assert not list(yoked_pairs([replace(trials, space=COMMAND_SPACES[PAIR])]))


def test_yoked_muscles_that_work_against_each_other() -> None:
    trials = _trials()
    up = np.linspace(0.01, 0.09, 12).reshape(4, 3)
    columns = {"left_lateral_rectus": up, "right_medial_rectus": 0.1 - up}
    changed = replace(trials, columns={**trials.columns, **columns})
    # Another run with another gaze: both muscles are driven more.
    turned = {name: values + 0.05 for name, values in columns.items()}
    other = replace(trials, columns={**trials.columns, **turned})
    for tests in ([changed], [changed, other]):
        pairs = {pair.names: pair for pair in yoked_pairs(tests)}
        pair = pairs["right_medial_rectus", "left_lateral_rectus"]
        assert pair.correlation == pytest.approx(-1.0)


def test_a_change_shared_around_the_mean_at_each_distance() -> None:
    # Around the means at both distances: -1, 1, -1, 1, and -2, 2, 0, 0.
    values = np.array([[0.0, 2.0, 10.0, 12.0], [1.0, 5.0, 0.0, 0.0]])
    change = shared_change(values, np.array([0.5, 0.5, 6.0, 6.0]))
    assert change.slope == pytest.approx(4.0 / 4.0)
    assert change.correlation == pytest.approx(4.0 / np.sqrt(4.0 * 8.0))
    still = shared_change(np.array([[1.0, 1.0], [0.0, 1.0]]), np.array([1.0, 1.0]))
    assert np.isnan([still.slope, still.correlation]).all()
