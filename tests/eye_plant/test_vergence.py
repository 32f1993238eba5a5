"""Vergence, disparity and pixels against hand-computed values."""

import math

import pytest

from eye_plant import desired_vergence_deg, fixation_distance_m
from eye_plant.gaze_error import GazeError
from eye_plant.ground_truth import GroundTruth
from eye_plant.vergence import degrees_per_px, disparity_px
from lockstep import InputError

BASELINE_M = 0.056
FOCAL_LENGTH_PX = 257.34


@pytest.mark.parametrize(
    ("distance_m", "expected_deg"),
    # 2 atan(0.028 / d), by hand
    [(0.5, 6.4104), (1.0, 3.2077), (2.0, 1.6042), (6.0, 0.5348)],
)
def test_desired_vergence_is_that_of_the_paper(distance_m: float, expected_deg: float) -> None:
    assert desired_vergence_deg(distance_m, BASELINE_M) == pytest.approx(expected_deg, abs=1e-4)


@pytest.mark.parametrize("distance_m", [0.338, 0.5, 3.22, 6.0])
def test_fixation_distance_inverts_desired_vergence(distance_m: float) -> None:
    vergence_deg = desired_vergence_deg(distance_m, BASELINE_M)
    assert fixation_distance_m(vergence_deg, BASELINE_M) == pytest.approx(distance_m, rel=1e-12)


def test_vergence_error_is_positive_when_the_eyes_converge_too_little() -> None:
    truth = GroundTruth(
        adduction_deg=(1.6, 1.61),
        elevation_deg=(0.0, 0.0),
        torsion_deg=(0.0, 0.0),
        gaze_error=GazeError(3.2, 0.0, 0.0),
        desired_vergence_deg=6.41,
        metabolic_rate_w=0.0,
        initial_metabolic_rate_w=0.0,
        optimal_metabolic_rate_w=0.0,
    )
    assert truth.vergence_error_deg == pytest.approx(3.2)


def test_disparity_of_one_and_three_degrees() -> None:
    # 514.68 tan(0.5 deg) = 514.68 * 0.00872687; 514.68 tan(1.5 deg) = 514.68 * 0.0261859
    assert disparity_px(1.0, FOCAL_LENGTH_PX) == pytest.approx(4.49154, abs=1e-4)
    assert disparity_px(-3.0, FOCAL_LENGTH_PX) == pytest.approx(-13.47736, abs=1e-4)


def test_a_pixel_is_0_2226_degrees() -> None:
    assert degrees_per_px(FOCAL_LENGTH_PX) == pytest.approx(0.2226, abs=5e-5)


@pytest.mark.parametrize("distance_m", [0.0, -1.0, math.nan, math.inf])
def test_a_distance_that_is_none_is_refused(distance_m: float) -> None:
    with pytest.raises(InputError, match="distance_m: expected a positive number"):
        desired_vergence_deg(distance_m, BASELINE_M)


@pytest.mark.parametrize("vergence_deg", [0.0, -1.0, 180.0, math.nan])
def test_eyes_that_do_not_converge_fixate_nothing(vergence_deg: float) -> None:
    with pytest.raises(InputError, match="vergence_deg: expected"):
        fixation_distance_m(vergence_deg, BASELINE_M)
