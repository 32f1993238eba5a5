"""How sure a measure is: its mean over seeds with an interval, n being the number of seeds.

Trials of one seed share its learners, pictures and starts, so their number says nothing about how
another seed would do.
"""

from collections.abc import Sequence

import numpy as np
from scipy.special import stdtrit

from lockstep import InputError

# Of t intervals.
_LEVEL = 0.95


def over_seeds(values: Sequence[float] | np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the mean of the values of n seeds, and half the width of its 95 % t interval.

    values: (n,) or (n, ...), both results are of the shape of a seed's. Half the width is
    t_{n-1, 0.975} SD / sqrt(n), with the SD of n - 1 degrees of freedom (Student 1908), and nan for
    one seed. It holds for values that are normal over seeds; of shares near 100 % the interval may
    end beyond. Raises InputError without a seed.
    """
    array = np.asarray(values, dtype=np.float64)
    n = len(array)
    if n == 0:
        raise InputError("expected the values of one seed or more, got none")
    mean = array.mean(axis=0)
    if n == 1:
        return mean, np.full_like(mean, np.nan)
    t = stdtrit(n - 1, 0.5 + _LEVEL / 2.0)
    return mean, t * array.std(axis=0, ddof=1) / np.sqrt(n)
