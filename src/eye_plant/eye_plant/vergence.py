"""Vergence of two eyes that look straight ahead, and what an error of it shifts in pictures.

Both eyes lie symmetrically about the midline, baseline_m apart. The vergence angle is the sum of
both eyes' adduction. These are formulas: they take and return plain floats.
"""

import math

from lockstep import InputError


def desired_vergence_deg(distance_m: float, baseline_m: float, parallax_m: float = 0.0) -> float:
    """Return the vergence angle that fixates a point straight ahead.

    gamma* = 2 atan((b + p) / 2d)  (K17 eq. 6, where p = 0); d = distance_m > 0, b = baseline_m > 0.
    p = parallax_m > -b: of a stereogram at that distance, how much farther right the left eye's
    picture shows what both show; the lines of sight to it meet at d b / (b + p).
    """
    _require_positive("distance_m", distance_m)
    _require_positive("baseline_m", baseline_m)
    _require_positive("baseline_m + parallax_m", baseline_m + parallax_m)
    return math.degrees(2.0 * math.atan((baseline_m + parallax_m) / (2.0 * distance_m)))


def fixation_distance_m(vergence_deg: float, baseline_m: float) -> float:
    """Return the distance straight ahead at which the two lines of sight meet.

    d = b / (2 tan(gamma / 2)), the inverse of K17 eq. 6; 0 < gamma = vergence_deg < 180. Parallel
    or diverging eyes fixate nothing, which is an error here.
    """
    _require_positive("baseline_m", baseline_m)
    if not 0.0 < vergence_deg < 180.0:
        raise InputError(f"vergence_deg: expected a number in (0, 180), got {vergence_deg}")
    return baseline_m / (2.0 * math.tan(math.radians(vergence_deg) / 2.0))


def disparity_px(vergence_error_deg: float, focal_length_px: float) -> float:
    """Return how far right the plane's centre lies in the left picture relative to the right one.

    x_left - x_right = 2 F tan(e / 2), F = focal_length_px, e = vergence_error_deg shared equally by
    both eyes: an eye that converges too little by e / 2 sees the point e / 2 toward the nose.
    """
    _require_positive("focal_length_px", focal_length_px)
    return 2.0 * focal_length_px * math.tan(math.radians(vergence_error_deg) / 2.0)


def degrees_per_px(focal_length_px: float) -> float:
    """Return the visual angle of one pixel at the picture's centre, atan(1 / F) in degrees."""
    _require_positive("focal_length_px", focal_length_px)
    return math.degrees(math.atan(1.0 / focal_length_px))


def _require_positive(name: str, value: float) -> None:
    if not (value > 0.0 and math.isfinite(value)):
        raise InputError(f"{name}: expected a positive number, got {value}")
