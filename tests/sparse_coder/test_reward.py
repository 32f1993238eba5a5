import math

import numpy as np
import pytest

from lockstep.errors import InputError
from sparse_coder.reward import reward

ERRORS = np.array([0.1, 0.3])


def test_without_a_price_the_reward_is_the_negative_error_of_both_scales() -> None:
    assert reward(ERRORS, 1.4, 0.0) == pytest.approx(-0.4)


def test_energy_is_charged_by_its_weight() -> None:
    assert reward(ERRORS, 1.4, 0.035) == pytest.approx(-0.4 - 0.049)


@pytest.mark.parametrize("rate_w", [math.nan, math.inf, -0.1])
def test_a_bad_metabolic_rate_is_refused(rate_w: float) -> None:
    with pytest.raises(InputError, match="metabolic rate: expected 0 W or more"):
        reward(ERRORS, rate_w, 0.0)
