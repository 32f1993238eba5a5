"""The fit of the main sequence to saccades whose law is known."""

import numpy as np
import pytest

from active_binocular_vision.examinations.saccades.velocity import fitted

AMPLITUDES_DEG = np.array([1.0, 2.0, 5.0, 10.0, 20.0])


def test_the_law_of_exact_saccades_is_found() -> None:
    fit = fitted(AMPLITUDES_DEG, 500.0 * (1.0 - np.exp(-AMPLITUDES_DEG / 10.0)))
    assert fit.constant_deg == pytest.approx(10.0, rel=1e-3)
    assert fit.greatest_velocity_deg_s == pytest.approx(500.0, rel=1e-3)
    # At the constant, 1 - 1 / e of the greatest velocity.
    assert fit.peak_velocity_deg_s(np.array([10.0])) == pytest.approx([316.06], rel=1e-3)


@pytest.mark.parametrize("power", [1.0, 1.2])
def test_velocity_in_proportion_or_growing_faster_does_not_saturate(power: float) -> None:
    fit = fitted(AMPLITUDES_DEG, 3.0 * AMPLITUDES_DEG**power)
    assert (fit.constant_deg, fit.greatest_velocity_deg_s) == (None, None)
    if power == 1.0:
        assert fit.slope_per_s == pytest.approx(3.0)
        np.testing.assert_allclose(fit.peak_velocity_deg_s(AMPLITUDES_DEG), 3.0 * AMPLITUDES_DEG)
