"""Quartiles over pictures, of measures that some pictures may leave without a value."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from experiment_manager.measures.metrics import QUARTILES

_NAMES = ("lower_quartile", "median", "upper_quartile")


def quartiles_of(values: ArrayLike) -> dict[str, float | None]:
    """Return the quartiles of values (n,) by name; linear between two values."""
    return _named(np.quantile(np.asarray(values, np.float64), QUARTILES))


def censored_quartiles_of(values: Sequence[float]) -> dict[str, float | None]:
    """Return the quartiles of values of which some are infinite: beyond what was tried.

    Each is one of the values, None where that is infinite.
    """
    return _named(np.quantile(values, QUARTILES, method="inverted_cdf"))


def _named(quartiles: NDArray[np.float64]) -> dict[str, float | None]:
    values = (value if math.isfinite(value) else None for value in quartiles.tolist())
    return dict(zip(_NAMES, values, strict=True))


def in_prism_dioptres(quartiles_deg: dict[str, float | None]) -> dict[str, float | None]:
    """Return quartiles in deg as 100 tan(angle), the deviation in cm at 1 m (Prentice 1890)."""
    return {
        name: None if angle_deg is None else 100.0 * math.tan(math.radians(angle_deg))
        for name, angle_deg in quartiles_deg.items()
    }
