"""Eyes that obey Listing's law, and eyes that do not, made by hand."""

import numpy as np
import pytest

from active_binocular_vision.examinations.nine_positions.listing import (
    DisplacementPlane,
    displacement_plane,
    rotation_vectors,
    tilt_per_vergence,
)
from eye_plant.gaze_error import listing_torsion_deg

GAZES_DEG = [(a, e) for a in (-12.0, 3.0, 9.0) for e in (-10.0, 0.0, 7.0)]


def direction(left_deg: float, up_deg: float) -> np.ndarray:
    a, e = np.radians([left_deg, up_deg])
    return np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])


def shortest(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Return the rotation (3, 3) of one direction to another about the axis at right angles."""
    cross = np.cross(start, end)
    k = np.array(
        [[0.0, -cross[2], cross[1]], [cross[2], 0.0, -cross[0]], [-cross[1], cross[0], 0.0]]
    )
    return np.eye(3) + k + k @ k / (1.0 + start @ end)


def listing_eye(primary: np.ndarray, left_deg: float, up_deg: float) -> np.ndarray:
    """Return the rotation of an eye that obeys Listing's law from a primary position."""
    ahead = np.array([1.0, 0.0, 0.0])
    return shortest(primary, direction(left_deg, up_deg)) @ shortest(ahead, primary)


def listing_eyes(temporal_deg: float, up_deg: float) -> np.ndarray:
    """Return rotations (n, 2, 3, 3) of eyes with primary positions that mirror each other."""
    left, right = (direction(side * temporal_deg, up_deg) for side in (1.0, -1.0))
    return np.array([[listing_eye(left, *g), listing_eye(right, *g)] for g in GAZES_DEG])


def test_components_of_rotation_vectors() -> None:
    half = np.tan(np.radians(5.0))
    down, left = (shortest(np.eye(3)[0], direction(*to)) for to in ((0.0, -10.0), (10.0, 0.0)))
    vectors = rotation_vectors(np.array([[down, down], [left, left]]))
    # The left eye turns to the temple as it turns left, the right eye to the nose.
    np.testing.assert_allclose(vectors[0], [[0.0, half, 0.0]] * 2, atol=1e-15)
    np.testing.assert_allclose(vectors[1], [[0.0, 0.0, half], [0.0, 0.0, -half]], atol=1e-15)


def test_torsion_is_that_of_ground_truth() -> None:
    eyes = listing_eyes(7.0, 3.0)
    torsion_deg = 2.0 * np.degrees(np.arctan(rotation_vectors(eyes)[..., 0]))
    np.testing.assert_allclose(torsion_deg, [listing_torsion_deg(pair) for pair in eyes])
    assert np.abs(torsion_deg).max() > 0.1


def test_eyes_with_planes_turned_to_the_temple_are_extorted_as_they_look_down() -> None:
    eyes = listing_eyes(8.0, 0.0)
    for (_, up_deg), pair in zip(GAZES_DEG, eyes, strict=True):
        torsion_deg = rotation_vectors(pair)[:, 0]
        assert (np.sign(np.round(torsion_deg, 12)) == np.sign(up_deg)).all()


@pytest.mark.parametrize(("temporal_deg", "up_deg"), [(0.0, 0.0), (8.0, 0.0), (0.0, -6.0)])
def test_a_displacement_plane_turns_half_as_far_as_the_primary_position(temporal_deg, up_deg):
    vectors = rotation_vectors(listing_eyes(temporal_deg, up_deg))
    for i_side in range(2):
        plane = displacement_plane(vectors[:, i_side])
        assert plane.thickness_deg == pytest.approx(0.0, abs=1e-10)
        assert plane.offset_deg == pytest.approx(0.0, abs=1e-10)
        assert plane.temporal_tilt_deg == pytest.approx(temporal_deg / 2.0, abs=1e-10)
        assert plane.upward_tilt_deg == pytest.approx(up_deg / 2.0, abs=1e-10)


def test_torsion_in_a_plane_by_hand_and_of_eyes_in_it() -> None:
    plane = DisplacementPlane(1.0, temporal_tilt_deg=4.0, upward_tilt_deg=0.0, thickness_deg=0.0)
    # r_x = tan(0.5 deg) + tan(4 deg) tan(5 deg) = 0.014845; twice its arctangent.
    np.testing.assert_allclose(plane.torsion_deg(np.array([0.0, 10.0]), 0.0), [1.0, 1.70095], 1e-4)
    vectors = rotation_vectors(listing_eyes(8.0, -6.0))[:, 0]
    torsion_deg, down_deg, temple_deg = 2.0 * np.degrees(np.arctan(vectors.T))
    found = displacement_plane(vectors)
    for torsion, down, temple in zip(torsion_deg, down_deg, temple_deg, strict=True):
        assert found.torsion_deg(np.array([-down]), temple) == pytest.approx([torsion], abs=1e-9)


def test_eyes_of_ficks_order_leave_the_plane() -> None:
    """Eyes that turn left, then up, without rotation about the line of sight."""
    fick = [
        shortest(np.eye(3)[0], direction(a, 0.0)) @ shortest(np.eye(3)[0], direction(0.0, e))
        for a, e in ((-10.0, -10.0), (-10.0, 10.0), (10.0, -10.0), (10.0, 10.0))
    ]
    half = np.tan(np.radians(5.0))
    vectors = rotation_vectors(np.array([[r, r] for r in fick]))[:, 0]
    np.testing.assert_allclose(np.abs(vectors[:, 0]), half**2)
    # Of four residuals of that size, with three numbers fitted.
    thickness_deg = np.degrees(2.0 * np.sqrt(4.0) * half**2)
    assert displacement_plane(vectors).thickness_deg == pytest.approx(thickness_deg)


def test_torsion_everywhere_is_an_offset() -> None:
    vectors = np.array([[0.01, 0.0, 0.0], [0.01, 0.1, 0.0], [0.01, 0.0, 0.1], [0.01, 0.1, 0.1]])
    plane = displacement_plane(vectors)
    assert plane.offset_deg == pytest.approx(2.0 * np.degrees(np.arctan(0.01)))
    assert plane.temporal_tilt_deg == pytest.approx(0.0, abs=1e-10)


def test_planes_that_turn_with_vergence() -> None:
    vergences_deg = np.array([0.5, 1.6, 6.4])
    # The primary position turns half as far as the eyes converge, so the plane a quarter.
    tilts_deg = [
        displacement_plane(rotation_vectors(listing_eyes(v / 2.0, 0.0))[:, 1]).temporal_tilt_deg
        for v in vergences_deg
    ]
    assert tilt_per_vergence(np.array(tilts_deg), vergences_deg) == pytest.approx(0.25)
