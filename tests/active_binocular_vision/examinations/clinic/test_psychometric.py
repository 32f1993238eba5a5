"""A psychometric function and its interval, against functions and draws that are known."""

import numpy as np
import pytest

from active_binocular_vision.examinations.clinic.psychometric import (
    Psychometric,
    fitted,
    resampled,
)
from active_binocular_vision.examinations.clinic.stereo import DISPARITIES_DEG, StereoCurve

SIZES_DEG = np.array(DISPARITIES_DEG)


def test_a_function_by_hand() -> None:
    function = Psychometric(threshold=0.1, slope=2.0, lapse=0.04)
    # F is 1/2 at the threshold and 4/5 at twice that.
    np.testing.assert_allclose(function.right(np.array([0.1, 0.2])), (0.73, 0.5 + 0.46 * 0.8))
    np.testing.assert_allclose(function.right(np.array([1e-9, 1e9])), (0.5, 0.96))


@pytest.mark.parametrize(("threshold", "slope", "lapse"), [(0.1, 2.0, 0.0), (0.3, 1.2, 0.05)])
def test_the_function_that_made_the_answers_is_found(threshold, slope, lapse) -> None:
    made = Psychometric(threshold, slope, lapse)
    found = fitted(SIZES_DEG, made.right(SIZES_DEG), 1000)
    assert found.threshold == pytest.approx(threshold, rel=0.02)
    assert found.slope == pytest.approx(slope, rel=0.05)
    assert found.lapse == pytest.approx(lapse, abs=0.01)


def test_a_lapse_at_a_large_disparity_hardly_moves_the_threshold() -> None:
    whole = Psychometric(0.1, 2.0, 0.0).right(SIZES_DEG)
    lapsed = whole - 0.15 * (SIZES_DEG == 1.0)
    thresholds = [fitted(SIZES_DEG, share, 60).threshold for share in (whole, lapsed)]
    assert thresholds[1] == pytest.approx(thresholds[0], rel=0.2)


def test_eyes_that_see_nothing_or_everything_have_thresholds_beyond() -> None:
    assert fitted(SIZES_DEG, np.full(7, 0.5), 60).threshold > 2.0
    assert fitted(SIZES_DEG, np.full(7, 1.0), 60).threshold < 0.02


def test_an_interval_is_that_of_the_cases_and_not_of_their_trials() -> None:
    values = np.random.default_rng(3).normal(size=40)
    low, high = resampled(40, lambda drawn: float(values[drawn].mean())) or (0.0, 0.0)
    # Of a mean it is about 1.96 standard errors to either side.
    assert (high - low) / 2.0 == pytest.approx(1.96 * values.std() / np.sqrt(40), rel=0.15)
    assert low < values.mean() < high
    assert resampled(1, lambda _: 0.0) is None


def test_the_interval_of_a_stereo_threshold_is_wider_where_pictures_differ() -> None:
    right = Psychometric(0.1, 2.0, 0.0).right(SIZES_DEG)
    draw = np.random.default_rng(1)
    alike = draw.random((7, 2, 10, 3)) < right[:, None, None, None]
    # Before half of the pictures nothing is seen.
    apart = alike.copy()
    apart[:, :, ::2] = draw.random((7, 2, 5, 3)) < 0.5
    (low, high), wide = (StereoCurve(SIZES_DEG, of).interval_deg or (0, 0) for of in (alike, apart))
    assert low < 0.1 < high < 0.3
    assert wide[1] / wide[0] > high / low
