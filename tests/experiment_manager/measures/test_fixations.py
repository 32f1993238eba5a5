"""The measures of fixations, by hand."""

import numpy as np
import pytest

from experiment_manager import Trials
from experiment_manager.measures.fixations import fixation_measures
from experiment_manager.measures.results import Spread
from lockstep import ALL_MUSCLES, COMMAND_SPACES

SPACE = COMMAND_SPACES[ALL_MUSCLES]


def trials_of(columns: dict[str, np.ndarray]) -> Trials:
    shape = next(iter(columns.values())).shape
    return Trials(SPACE, 100, np.arange(shape[0]), columns, np.zeros(shape))


def fixations(left_deg: float = 0.0, right_deg: float = 0.0) -> Trials:
    """Two trials of two fixations of 10 iterations; the second one's target is so far aside."""
    zeros = np.zeros((2, 21))
    sideways, up, horizontal, vertical = zeros.copy(), zeros.copy(), zeros.copy(), zeros.copy()
    for begin in (0, 10):
        sideways[:, begin : begin + 3] = [[5.0, 0.3, 0.03], [8.0, -0.6, 0.06]]
        up[:, begin : begin + 3] = [[0.0, 0.4, 0.04], [0.0, 0.8, 0.08]]
        # The line of sight then moves by 0.1 and 0.2 deg.
        sideways[:, begin + 7] = [0.13, 0.06]
        up[:, begin + 7] = [0.04, -0.12]
    sideways[:, 10:] += left_deg
    horizontal[:, 7], vertical[:, 7] = [0.1, -0.3], [-0.1, 0.0]
    horizontal[:, 17], vertical[:, 17] = [0.2, 0.0], [0.25, 0.02]
    return trials_of(
        {
            "target_sideways_deg": sideways,
            "target_up_deg": up,
            "right_target_sideways_deg": zeros + right_deg,
            "right_target_up_deg": zeros,
            "vergence_error_deg": horizontal,
            "vertical_error_deg": vertical,
            "cyclovergence_error_deg": zeros + 0.5,
        }
    )


def test_what_saccades_miss_and_what_is_left_five_iterations_later() -> None:
    found = fixation_measures(fixations(), 10, px_deg=0.2226)
    for spread, expected in (
        (found["saccade_error_deg"]["after_1"], (0.75, 1.0)),
        (found["saccade_error_deg"]["after_2"], (0.075, 0.1)),
        (found["gaze_drift_deg"], (0.15, 0.2)),
    ):
        assert (spread.median, spread.p90) == pytest.approx(expected)
    # |h| is 0.1, 0.3, 0.2, 0, |v| 0.1, 0, 0.25, 0.02.
    assert found["fixated_horizontal_error_deg"].median == pytest.approx(0.15)
    assert found["fixated_vertical_error_deg"].median == pytest.approx(0.06)
    assert found["fixated_cyclovergence_error_deg"] == Spread(0.5, 0.5)
    assert found["share_fixated_within_1_px"] == 0.5
    assert found["share_right_eye_leads"] == 0.0


@pytest.mark.parametrize(
    ("left_deg", "right_deg", "share"), [(10.0, 0.5, 0.5), (10.0, 30.0, 0.0), (0.5, 0.0, 0.0)]
)
def test_the_right_eye_leads_where_the_left_one_does_not_look(left_deg, right_deg, share) -> None:
    found = fixation_measures(fixations(left_deg, right_deg), 10, px_deg=0.2226)
    assert found["share_right_eye_leads"] == share
    if share:
        errors_deg = [0.05, 0.1, right_deg, right_deg]
        assert found["saccade_error_deg"]["after_2"].median == pytest.approx(np.median(errors_deg))


def test_a_short_fixation_is_judged_at_its_end() -> None:
    found = fixation_measures(fixations(), 5, px_deg=0.2226)
    assert found["fixated_horizontal_error_deg"].median == 0.0


def test_nothing_is_measured_where_nothing_was_recorded() -> None:
    empty = trials_of({"vergence_error_deg": np.full((2, 21), np.nan)})
    assert fixation_measures(empty, 10, px_deg=0.2226) == {}
