"""How sure a measure is: its mean over seeds with an interval, n being the number of seeds.

Trials of one seed share its learners, pictures and starts, so their number says nothing about how
another seed would do.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import stdtrit

from lockstep import InputError

# Of t intervals.
LEVEL = 0.95


@dataclass(frozen=True)
class OverSeeds:
    """Mean of a measure over n seeds, and half the width of its 95 % t interval.

    mean, half_width: of the shape of a seed's values; half_width is nan for one seed.
    """

    mean: np.ndarray
    half_width: np.ndarray
    n: int

    @property
    def band(self) -> np.ndarray:
        """Lower end, mean and upper end, (3, ...)."""
        return np.stack([self.mean - self.half_width, self.mean, self.mean + self.half_width])


def over_seeds(values: Sequence[float] | np.ndarray) -> OverSeeds:
    """Return mean and interval of the values of seeds, (n_seeds,) or (n_seeds, ...).

    mean +- t_{n-1, 0.975} SD / sqrt(n), with the SD of n - 1 degrees of freedom (Student 1908). It
    holds for values that are normal over seeds; of shares near 100 % its end may lie beyond. Raises
    InputError without a seed.
    """
    array = np.asarray(values, dtype=np.float64)
    n = len(array)
    if n == 0:
        raise InputError("expected the values of one seed or more, got none")
    mean = array.mean(axis=0)
    if n == 1:
        return OverSeeds(mean, np.full_like(mean, np.nan), n)
    t = stdtrit(n - 1, 0.5 + LEVEL / 2.0)
    return OverSeeds(mean, t * array.std(axis=0, ddof=1) / np.sqrt(n), n)
