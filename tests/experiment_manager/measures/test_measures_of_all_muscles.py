"""What is measured where each muscle has a command of its own, by hand and through its files."""

from dataclasses import replace
from pathlib import Path

import msgspec
import numpy as np
import pytest

from experiment_manager import Criteria, Summary, summary_of
from experiment_manager.measures.kept_trials import with_test, write_trials
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
    return only_test(TrialTable(np.array(rows)), 2)


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
    assert left.share_silent == pytest.approx(2 / 4)
    assert left.median_co_contraction == pytest.approx((0.004 + 0.08) / 2)
    assert left.share_silent_by_distance == {"0.5": 1.0, "2": 0.0}
    # Above its floor the superior rectus is driven by 0.004 and 0.006; once the other is silent.
    vertical = pairs["left_superior_rectus-left_inferior_rectus"]
    assert vertical.share_silent == pytest.approx(2 / 4)
    assert vertical.median_co_contraction == pytest.approx((0.004 + 0.006) / 2)
    assert pairs["right_superior_oblique-right_inferior_oblique"].share_silent == 0.0


def test_eyes_with_a_silent_horizontal_rectus_by_hand() -> None:
    # Of eight eyes: the left one twice, the right one once.
    assert summary_of(_trials(), CRITERIA).share_antagonist_silent == pytest.approx(3 / 8)


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
        [pair.share_silent for pair in summary_of(trials, CRITERIA).antagonists.values()]
        for trials in (kept, whole)
    )
    assert shares == expected
    first, _ = kept_tests(tmp_path)
    for pair in summary_of(first, CRITERIA).antagonists.values():
        # Activations are kept of the last test only.
        assert pair.share_silent is None
        assert set(pair.share_silent_by_distance.values()) == {None}


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
