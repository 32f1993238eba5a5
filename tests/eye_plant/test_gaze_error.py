import math

import numpy as np
import pytest

from eye_plant import desired_vergence_deg
from eye_plant.gaze_error import (
    gaze_error,
    listing_torsion_deg,
    target_place_deg,
    target_places_deg,
)
from tests.eye_plant.rotations import rotation, turned_inward

BASELINE_M = 0.056
POSITIONS_M = np.array([[0.0, BASELINE_M / 2, 1.7], [0.0, -BASELINE_M / 2, 1.7]])


def fixating(point_m: np.ndarray) -> np.ndarray:
    """Return the rotations (2, 3, 3) of eyes without torsion that look at a point."""
    eyes = []
    for x, y, z in point_m - POSITIONS_M:
        eyes.append(rotation(math.degrees(math.atan2(y, x)), math.degrees(math.atan2(z, x))))
    return np.array(eyes)


@pytest.mark.parametrize("distance_m", [0.5, 1.0, 6.0])
def test_eyes_that_fixate_the_middle_have_no_error(distance_m: float) -> None:
    error = gaze_error(POSITIONS_M, fixating(np.array([distance_m, 0.0, 1.7])), distance_m)
    assert error.horizontal_deg == pytest.approx(0.0, abs=1e-9)
    assert error.vertical_deg == pytest.approx(0.0, abs=1e-9)
    assert error.torsional_deg == pytest.approx(0.0, abs=1e-6)


def test_too_little_convergence_is_positive_and_counts_in_degrees() -> None:
    half_deg = desired_vergence_deg(1.0, BASELINE_M) / 2.0
    for short_deg in (0.5, -2.0):
        eyes = turned_inward(half_deg, half_deg - short_deg)
        error = gaze_error(POSITIONS_M, eyes, 1.0)
        assert error.horizontal_deg == pytest.approx(short_deg, abs=1e-9)
        assert error.vertical_deg == pytest.approx(0.0, abs=1e-9)


def test_a_higher_left_eye_is_positive() -> None:
    # Far away and straight ahead: both lines of sight are parallel.
    error = gaze_error(POSITIONS_M, np.array([rotation(0, 1.5), rotation(0, 1.0)]), 1e6)
    assert error.vertical_deg == pytest.approx(0.5, abs=1e-4)
    assert error.horizontal_deg == pytest.approx(0.0, abs=1e-4)


def test_a_right_eye_turned_counterclockwise_sees_things_turned_clockwise() -> None:
    eyes = np.array([rotation(0, 0), rotation(0, 0, -3.0)])
    assert gaze_error(POSITIONS_M, eyes, 1e6).torsional_deg == pytest.approx(3.0, abs=1e-4)
    both = np.array([rotation(0, 0, -2.0), rotation(0, 0, -2.0)])
    assert gaze_error(POSITIONS_M, both, 1e6).torsional_deg == pytest.approx(0.0, abs=1e-4)


def test_a_stereogram_is_fixated_where_its_lines_of_sight_meet() -> None:
    parallax_m = 0.01
    half_deg = desired_vergence_deg(0.8, BASELINE_M, parallax_m) / 2.0
    error = gaze_error(POSITIONS_M, turned_inward(half_deg, half_deg), 0.8, parallax_m)
    assert error.horizontal_deg == pytest.approx(0.0, abs=1e-9)


def test_an_eye_that_looks_away_from_the_plane_has_no_error_to_tell() -> None:
    error = gaze_error(POSITIONS_M, np.array([rotation(95, 0), rotation(0, 0)]), 1.0)
    assert math.isnan(error.horizontal_deg)
    assert math.isnan(error.torsional_deg)


def test_eyes_that_turn_about_one_axis_in_listings_plane_have_no_torsion() -> None:
    # Sideways alone, or up alone.
    eyes = np.array([rotation(12.0, 0.0), rotation(0.0, -9.0)])
    assert listing_torsion_deg(eyes) == pytest.approx((0.0, 0.0), abs=1e-12)


def test_torsion_is_positive_where_upper_poles_lean_to_the_nose() -> None:
    # Clockwise is to the right: the left eye's nose, the right eye's temple.
    eyes = np.array([rotation(0.0, 0.0, 3.0), rotation(0.0, 0.0, 3.0)])
    assert listing_torsion_deg(eyes) == pytest.approx((3.0, -3.0))


def test_an_oblique_gaze_in_ficks_order_has_false_torsion() -> None:
    # tan(torsion / 2) = -tan(azimuth / 2) tan(elevation / 2) about the line of sight before both.
    azimuth_deg, elevation_deg = 10.0, 20.0
    false_deg = 2.0 * math.degrees(
        math.atan(math.tan(math.radians(azimuth_deg / 2)) * math.tan(math.radians(10.0)))
    )
    eyes = np.array([rotation(azimuth_deg, elevation_deg)] * 2)
    left, right = listing_torsion_deg(eyes)
    assert abs(left) == pytest.approx(false_deg)
    assert right == pytest.approx(-left)


@pytest.mark.parametrize(
    ("eye", "direction_deg", "expected_deg"),
    [
        ((0.0, 0.0), (0.0, 0.0), (0.0, 0.0)),
        ((0.0, 0.0), (7.0, 0.0), (7.0, 0.0)),
        ((0.0, 0.0), (0.0, -4.0), (0.0, -4.0)),
        # An eye that looks 5 deg to the right and 3 deg up has its target there.
        ((-5.0, 3.0), (5.0, 3.0), (0.0, 0.0)),
        ((-5.0, 0.0), (8.0, 0.0), (3.0, 0.0)),
        # Its upper pole leans to the right: what is up in the world is up and to the left for it.
        ((0.0, 0.0, 90.0), (0.0, 6.0), (-6.0, 0.0)),
    ],
)
def test_where_an_eye_sees_a_target(eye, direction_deg, expected_deg) -> None:
    found_deg = target_place_deg(rotation(*eye), *direction_deg)
    np.testing.assert_allclose(found_deg, expected_deg, atol=1e-9)


@pytest.mark.parametrize("aside_deg", [0.0, 10.0])
def test_both_eyes_see_a_target_where_it_stands_on_the_plane(aside_deg: float) -> None:
    # 0.5 m ahead of the left eye and 8 deg to the right; the right eye looks farther to the right.
    target_m = POSITIONS_M[0] + [0.5, -0.5 * math.tan(math.radians(8.0)), 0.0]
    eyes = fixating(target_m)
    eyes[1] = rotation(-aside_deg, 0.0) @ eyes[1]
    places_deg = target_places_deg(POSITIONS_M, eyes, (8.0, 0.0), 0.5)
    np.testing.assert_allclose(places_deg, [0.0, 0.0, -aside_deg, 0.0], atol=1e-9)


def test_a_common_turn_of_converged_eyes_before_a_frontal_plane_is_not_neutral() -> None:
    half_deg = desired_vergence_deg(0.5, BASELINE_M) / 2.0
    converged = turned_inward(half_deg, half_deg)
    up = rotation(0.0, 8.0)
    # Each eye about its own transverse axis, or both about the head's, before which the plane
    # leans: the angle between both ways is 8 deg times the sine of the vergence.
    own, of_head = (gaze_error(POSITIONS_M, e, 0.5) for e in (converged @ up, up @ converged))
    assert own.torsional_deg == pytest.approx(-0.447, abs=1e-3)
    assert of_head.torsional_deg == pytest.approx(0.446, abs=1e-3)
    both_deg = 8.0 * math.sin(math.radians(2.0 * half_deg))
    assert of_head.torsional_deg - own.torsional_deg == pytest.approx(both_deg, rel=0.01)
