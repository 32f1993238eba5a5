"""How an eye turned between two of its pictures, from the pictures alone.

An eye that turns about its centre sees the same directions before and after, whatever their
distance. So its picture moves by the homography K R K^-1, K being the camera's matrix, and the
rotation R is all that has to be found (Hartley & Zisserman 2003, section 8.4.2).

Camera axes: x right, y down, z forward. A movement m = (sideways, up, clockwise) in deg is a turn
of the line of sight by the angle |(sideways, up)| in that direction, followed by a rotation about
it. So the place in the earlier picture that is sideways and up from its centre comes to the centre.
"""

import math

import cv2
import numpy as np
from numpy.typing import NDArray

Picture = NDArray[np.uint8]
Floats = NDArray[np.float64]

# Rounds of aligning what the round before has left.
_N_ROUNDS = 2
_STOP = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 30, 1e-4)
_BLUR_PX = 5
# Of both pictures once aligned, in [-1, 1]; below it the movement is not clear.
_LEAST_CORRELATION = 0.8
_UNCLEAR = np.full(3, np.nan)


def movement(earlier: Picture, later: Picture, focal_length_px: float) -> Floats:
    """Return the movement (3,) between two pictures (height_px, width_px) of one eye, in deg.

    NaN where it is not clear: a picture is uniform, or the two do not align or differ too much.

    First the peak of their phase correlation (Kuglin & Hines 1975), then the shift and rotation of
    largest correlation of their centres (Evangelidis & Psarakis 2008), both pictures turned half
    of the way towards each other, so that half of a picture has to be common to both.
    """
    side_px = _side_px(min(earlier.shape))
    if earlier.min() == earlier.max() or later.min() == later.max():
        return _UNCLEAR.copy()
    window = cv2.createHanningWindow((side_px, side_px), cv2.CV_32F)
    first, second = (_centre(picture, side_px) for picture in (earlier, later))
    (to_right, down), _ = cv2.phaseCorrelate(first, second, window)
    turned = _turned(-to_right, -down, 0.0, focal_length_px)
    for _ in range(_N_ROUNDS):
        half = _rodrigues(_rodrigues(turned) / 2.0)
        size_px = side_px // 2
        a = _seen(earlier, half, size_px, focal_length_px)
        b = _seen(later, half.T, size_px, focal_length_px)
        start = np.eye(2, 3, dtype=np.float32)
        everywhere = np.ones_like(a)
        try:
            correlation, found = cv2.findTransformECC(
                a, b, start, cv2.MOTION_EUCLIDEAN, _STOP, everywhere, _BLUR_PX
            )
        except cv2.error:
            return _UNCLEAR.copy()
        centre = np.array([(size_px - 1) / 2.0, (size_px - 1) / 2.0, 1.0])
        warp = np.asarray(found, np.float64)
        to_right, down = warp @ centre - centre[:2]
        rest = _turned(-to_right, -down, -math.atan2(warp[1, 0], warp[0, 0]), focal_length_px)
        turned = half @ rest @ half
    if not correlation >= _LEAST_CORRELATION:  # also true of NaN
        return _UNCLEAR.copy()
    return angles_deg(turned)


def rotation(movement_deg: Floats) -> Floats:
    """Return R (3, 3) of a movement (3,): the later camera's axes in the earlier one's."""
    sideways, up, clockwise = np.radians(movement_deg)
    return _rodrigues(np.array([up, sideways, 0.0])) @ _rodrigues(np.array([0.0, 0.0, clockwise]))


def angles_deg(turned: Floats) -> Floats:
    """Return the movement (3,) of a rotation R (3, 3): the inverse of `rotation`."""
    sideways_deg, up_deg = swing_deg(turned[:, 2])
    roll = rotation(np.array([sideways_deg, up_deg, 0.0])).T @ turned
    return np.array([sideways_deg, up_deg, math.degrees(math.atan2(roll[1, 0], roll[0, 0]))])


def swing_deg(ahead: Floats) -> Floats:
    """Return the movement (2,), sideways and up, that brings a direction (3,) to the centre."""
    x, y, z = ahead
    aside = math.hypot(x, y)
    ratio = math.degrees(math.atan2(aside, z)) / aside if aside > 0.0 else 1.0
    return np.array([x * ratio, -y * ratio])


def _turned(right_px: float, down_px: float, clockwise: float, focal_length_px: float) -> Floats:
    swing = np.array([-down_px, right_px, 0.0]) / focal_length_px
    return _rodrigues(swing) @ _rodrigues(np.array([0.0, 0.0, clockwise]))


def _rodrigues(turn: Floats) -> Floats:
    """Return the rotation R (3, 3) of a vector (3,), or the vector of a rotation."""
    return np.asarray(cv2.Rodrigues(turn)[0], np.float64)


def _side_px(most_px: int) -> int:
    """Return the largest side that phaseCorrelate does not pad: padding can shift its peak."""
    return next(n for n in range(most_px, 0, -1) if cv2.getOptimalDFTSize(n) == n)


def _centre(picture: Picture, side_px: int) -> NDArray[np.float32]:
    top, left = ((n - side_px) // 2 for n in picture.shape)
    return picture[top : top + side_px, left : left + side_px].astype(np.float32)


def _seen(picture: Picture, turned: Floats, size_px: int, focal_length_px: float) -> Picture:
    """Return the centre (size_px, size_px) of what a camera turned by R (3, 3) would see."""
    source, target = (
        np.array([[focal_length_px, 0, (w - 1) / 2], [0, focal_length_px, (h - 1) / 2], [0, 0, 1]])
        for h, w in (picture.shape, (size_px, size_px))
    )
    return np.asarray(
        cv2.warpPerspective(
            picture,
            source @ turned @ np.linalg.inv(target),
            (size_px, size_px),
            flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP,
        ),
        np.uint8,
    )
