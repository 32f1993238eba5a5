"""Quartiles over pictures, of measures that some pictures may leave without a value."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from experiment_manager.measures.metrics import QUARTILES

_NAMES = ("lower_quartile", "median", "upper_quartile")


def quartiles_of(values: ArrayLike) -> dict[str, float | None]:
    """Return the quartiles of values (n,) by name; linear between two values."""
    found = np.quantile(np.asarray(values, dtype=np.float64), QUARTILES)
    return dict(zip(_NAMES, map(_plain, found.tolist()), strict=True))


def censored_quartiles_of(values: Sequence[float]) -> dict[str, float | None]:
    """Return the quartiles of values of which some are infinite: beyond what was tried.

    Each is one of the values, None where that is infinite.
    """
    found = np.quantile(values, QUARTILES, method="inverted_cdf")
    return dict(zip(_NAMES, map(_plain, found.tolist()), strict=True))


def _plain(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def prism_dioptres(angle_deg: float | None) -> float | None:
    """Return 100 tan(angle), the deviation in cm at 1 m (Prentice 1890); None of None."""
    return None if angle_deg is None else 100.0 * math.tan(math.radians(angle_deg))


def in_prism_dioptres(quartiles_deg: dict[str, float | None]) -> dict[str, Any]:
    """Return quartiles in deg as prism dioptres."""
    return {name: prism_dioptres(angle_deg) for name, angle_deg in quartiles_deg.items()}
