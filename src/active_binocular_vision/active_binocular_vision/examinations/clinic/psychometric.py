"""How often answers are right over the size of what is to be seen: a psychometric function.

psi(x) = 1/2 + (1/2 - lapse) F,  F = 1 / (1 + (threshold / x)^slope)
(Wichmann & Hill 2001: two alternatives; F is logistic over ln x.) The threshold is where F is a
half: 75 % right without lapses.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.special import expit

from lockstep import generator

Array = NDArray[np.float64]

_MOST_LAPSES = 0.1
_SLOPES = (0.3, 10.0)
# Starts of the search: thresholds over the range of sizes.
_N_STARTS = 4
_N_RESAMPLED = 200
_ENDS = (0.025, 0.975)
_SEED = 0


@dataclass(frozen=True)
class Psychometric:
    """threshold: of the unit of the sizes; slope: over ln x; lapse: share of careless answers."""

    threshold: float
    slope: float
    lapse: float

    def right(self, size: Array) -> Array:
        """Return the share of right answers at sizes."""
        seen = expit(self.slope * np.log(size / self.threshold))
        return np.asarray(0.5 + (0.5 - self.lapse) * seen)


def fitted(size: Array, share_right: Array, n_trials: int) -> Psychometric:
    """Return the function of the greatest likelihood; its threshold is at most twice off the sizes.

    size: (n,) above 0, rising; share_right: (n,) of n_trials each.
    """
    right = n_trials * share_right
    low, high = np.log([size[0] / 2.0, 2.0 * size[-1]])

    def misfit(values: Array) -> float:
        psi = Psychometric(np.exp(values[0]), values[1], values[2]).right(size)
        psi = np.clip(psi, 1e-9, 1.0 - 1e-9)
        return float(-(right * np.log(psi) + (n_trials - right) * np.log1p(-psi)).sum())

    bounds = ((low, high), _SLOPES, (0.0, _MOST_LAPSES))
    found = [
        minimize(misfit, (start, 2.0, 0.02), method="L-BFGS-B", bounds=bounds)
        for start in np.linspace(low, high, _N_STARTS + 2)[1:-1]
    ]
    log_threshold, slope, lapse = min(found, key=lambda result: result.fun).x
    return Psychometric(float(np.exp(log_threshold)), float(slope), float(lapse))


def resampled(n: int, value: Callable[[NDArray[np.intp]], float]) -> tuple[float, float] | None:
    """Return the 95 % bootstrap interval of a value over n independent cases; None for one case.

    value: of the cases with these numbers, (n,), each as often as it was drawn. Trials that share a
    case, such as a picture, are not independent, so that cases are drawn and not trials.
    """
    if n < 2:
        return None
    draws = (generator(_SEED, "bootstrap", i).integers(n, size=n) for i in range(_N_RESAMPLED))
    low, high = np.quantile([value(drawn) for drawn in draws], _ENDS, method="inverted_cdf")
    return float(low), float(high)
