"""How far two eyes are from looking at the same thing: the disparity where the left fovea looks.

World frame: x forward, y left, z up; the plane stands at x = distance_m, facing the eyes.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class GazeError:
    """Disparity of the plane at the left fovea, as the right eye sees it; all 0 when both fixate.

    horizontal_deg: above 0 when the eyes converge too little; vertical_deg: above 0 when the left
    eye is higher; torsional_deg: rotation of what lies around, above 0 when the right eye sees it
    turned clockwise against the left one: the eyes' upper poles lean towards each other too far
    (incyclovergence). NaN when the left eye does not look towards the plane.
    """

    horizontal_deg: float
    vertical_deg: float
    torsional_deg: float


def gaze_error(
    positions_m: NDArray[np.float64],
    rotations: NDArray[np.float64],
    distance_m: float,
    parallax_m: float = 0.0,
) -> GazeError:
    """Return the error of two eyes before a plane.

    positions_m: (2, 3) of left and right eye; rotations: (2, 3, 3), columns forward, left and up of
    each eye; parallax_m: of a stereogram, how much farther right the left eye's picture shows what
    both show. The rotation is the antisymmetric part of the map from directions in the left eye to
    those in the right one. (ours: what the pictures show, whatever the eyes' version.)
    """
    (forward, left, up), right_axes = rotations.transpose(0, 2, 1).tolist()
    (left_x, left_y, left_z), (right_x, right_y, right_z) = positions_m.tolist()
    if forward[0] <= 0.0:
        return GazeError(math.nan, math.nan, math.nan)
    reach = (distance_m - left_x) / forward[0]
    # From the right eye to what it sees of the point on the plane at which the left one looks.
    point = (
        distance_m - right_x,
        left_y + reach * forward[1] + parallax_m - right_y,
        left_z + reach * forward[2] - right_z,
    )
    seen = _in(right_axes, point)
    ahead, leftward, upward = seen
    # The point moves over the plane as the direction turns, by one unit of tan, left or up.
    to_left, to_up = (
        _in(
            right_axes,
            [reach * (a - f * axis[0] / forward[0]) for a, f in zip(axis, forward, strict=True)],
        )
        for axis in (left, up)
    )
    return GazeError(
        math.degrees(math.atan2(leftward, ahead)),
        math.degrees(math.atan2(upward, ahead)),
        -math.degrees(_turned_rad(seen, to_left, to_up)),
    )


def target_place_deg(
    rotation: NDArray[np.float64], azimuth_deg: float, elevation_deg: float
) -> tuple[float, float]:
    """Return where an eye sees a direction: how far to the right and up of its line of sight.

    rotation: (3, 3) of the eye, columns forward, left and up; azimuth_deg: of the direction, to the
    right; elevation_deg. The angle from the line of sight, in that direction in the picture.
    """
    azimuth, elevation = math.radians(azimuth_deg), math.radians(elevation_deg)
    direction = (
        math.cos(elevation) * math.cos(azimuth),
        -math.cos(elevation) * math.sin(azimuth),
        math.sin(elevation),
    )
    ahead, left, up = _in(rotation.T.tolist(), direction)
    aside = math.hypot(left, up)
    ratio = math.degrees(math.atan2(aside, ahead)) / aside if aside > 0.0 else 1.0
    return -left * ratio, up * ratio


def wanted_gaze_deg(
    positions_m: NDArray[np.float64], target_deg: Sequence[float], distance_m: float
) -> NDArray[np.float64]:
    """Return azimuth (right) and elevation (2, 2) of left and right eye that look at a target.

    positions_m: (2, 3) of the eyes, x forward, y left, z up; target_deg: (2,) azimuth and elevation
    from the left eye of a point on the plane at x = distance_m.
    """
    azimuth, elevation = np.radians(target_deg)
    forward = np.array([1.0, -np.tan(azimuth), np.tan(elevation) / np.cos(azimuth)])
    left_m, right_m = positions_m
    point_m = left_m + (distance_m - left_m[0]) * forward
    return np.stack([direction_deg(point_m - left_m), direction_deg(point_m - right_m)])


def direction_deg(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return azimuth (right) and elevation (..., 2) of vectors (..., 3), forward, left, up."""
    forward, left, up = np.moveaxis(vectors, -1, 0)
    angles = np.arctan2(-left, forward), np.arctan2(up, np.hypot(forward, left))
    return np.degrees(np.stack(angles, axis=-1))


def target_places_deg(
    positions_m: NDArray[np.float64],
    rotations: NDArray[np.float64],
    target_deg: Sequence[float],
    distance_m: float,
) -> tuple[float, ...]:
    """Return where the left and the right eye see a target: how far to the right and up each.

    rotations: (2, 3, 3), as for target_place_deg; others: as for wanted_gaze_deg.
    """
    of_left, of_right = rotations
    from_right_deg = wanted_gaze_deg(positions_m, target_deg, distance_m)[1].tolist()
    return *target_place_deg(of_left, *target_deg), *target_place_deg(of_right, *from_right_deg)


def listing_torsion_deg(rotations: NDArray[np.float64]) -> tuple[float, float]:
    """Return each eye's torsion in Listing's coordinates, its upper pole turned to the nose > 0.

    rotations: (2, 3, 3) of left and right eye, columns forward, left and up. The part about the
    line straight ahead of the one rotation from there to the eye's place, 2 atan(r_x) of the
    rotation vector r (Haustein 1989): 0 for all gazes that obey Listing's law with a primary
    position straight ahead.
    """
    left, right = (
        2.0 * math.degrees(math.atan2(r[2][1] - r[1][2], 1.0 + r[0][0] + r[1][1] + r[2][2]))
        for r in rotations.tolist()
    )
    return left, -right


def _in(axes: Sequence[Sequence[float]], vector: Sequence[float]) -> list[float]:
    """Return the components of a vector along three axes."""
    x, y, z = vector
    return [a * x + b * y + c * z for a, b, c in axes]


def _turned_rad(seen: Sequence[float], to_left: Sequence[float], to_up: Sequence[float]) -> float:
    """Return the rotation of directions about one that is seen, all (ahead, left, up).

    to_left, to_up: how what is seen moves as the other eye's direction turns left and up.
    """
    ahead, leftward, upward = seen
    return math.atan2(
        _turn(to_up[1], leftward, to_up[0], ahead) - _turn(to_left[2], upward, to_left[0], ahead),
        _turn(to_left[1], leftward, to_left[0], ahead) + _turn(to_up[2], upward, to_up[0], ahead),
    )


def _turn(aside_rate: float, aside: float, ahead_rate: float, ahead: float) -> float:
    """Return the derivative of atan2(aside, ahead)."""
    return (ahead * aside_rate - aside * ahead_rate) / (ahead * ahead + aside * aside)
