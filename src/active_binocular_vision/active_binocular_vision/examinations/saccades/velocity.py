"""The main sequence: how peak velocity grows with the amplitude of saccades."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

Array = NDArray[np.float64]

# A constant above it cannot be told from a straight line.
_LARGEST_CONSTANT_DEG = 1000.0
_SMALLEST_CONSTANT_DEG = 1.0


@dataclass(frozen=True)
class MainSequence:
    """Peak velocity = V (1 - exp(-A / a)) of saccades of amplitude A.

    (Dai, Selesnick, Rizzo, Rucker & Hudson 2016, doi 10.1109/SPMB.2016.7846860)

    slope_per_s: V / a, the velocity per amplitude of small saccades; constant_deg: a, None where
    velocity grows in proportion to amplitude.
    """

    slope_per_s: float
    constant_deg: float | None

    @property
    def greatest_velocity_deg_s(self) -> float | None:
        """V, None where velocity grows in proportion to amplitude."""
        return None if self.constant_deg is None else self.slope_per_s * self.constant_deg

    def peak_velocity_deg_s(self, amplitude_deg: Array) -> Array:
        """Return the peak velocity at amplitudes."""
        constant_deg = self.constant_deg
        growth = amplitude_deg if constant_deg is None else _growth(amplitude_deg, constant_deg)
        return self.slope_per_s * growth


def fitted(amplitude_deg: Array, peak_velocity_deg_s: Array) -> MainSequence:
    """Fit the main sequence to saccades (n,) by least squares of peak velocity.

    The constant is sought from 1 to 1000 deg.
    """

    def slope_of(growth: Array) -> float:
        return float(growth @ peak_velocity_deg_s / (growth @ growth))

    def squares(per_constant: float) -> float:
        growth = _growth(amplitude_deg, 1.0 / per_constant)
        return float(((peak_velocity_deg_s - slope_of(growth) * growth) ** 2).sum())

    bounds = 1.0 / _LARGEST_CONSTANT_DEG, 1.0 / _SMALLEST_CONSTANT_DEG
    found = minimize_scalar(squares, bounds=bounds, method="bounded", options={"xatol": 1e-8})
    line_slope = slope_of(amplitude_deg)
    of_line = ((peak_velocity_deg_s - line_slope * amplitude_deg) ** 2).sum()
    if of_line <= found.fun:
        return MainSequence(line_slope, None)
    constant_deg = 1.0 / float(found.x)
    return MainSequence(slope_of(_growth(amplitude_deg, constant_deg)), constant_deg)


def _growth(amplitude_deg: Array, constant_deg: float) -> Array:
    """Return a (1 - exp(-A / a)), which is A where A is small."""
    return -constant_deg * np.expm1(-amplitude_deg / constant_deg)
