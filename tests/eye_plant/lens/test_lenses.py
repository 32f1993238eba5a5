"""Lenses and pupils against values computed by hand."""

import math
from typing import Any

import numpy as np
import pytest

from eye_plant.lens.config import LensesConfig
from eye_plant.lens.lenses import Lenses, LensState, amplitude_d, ciliary_activation
from lockstep import InputError

# Ciliary muscle and sphincter of both eyes.
COMMAND = np.array([0.2, 0.5, 0.4, 1.0])


def settled(command: np.ndarray = COMMAND, **settings: Any) -> LensState:
    lenses = Lenses(LensesConfig(**settings))
    lenses.settle(command)
    return lenses.state()


def test_dioptres_and_diameters_follow_the_activations() -> None:
    """At 20 years the range is 12.5 D, and pupils go from 8 to 2 mm."""
    state = settled()
    np.testing.assert_allclose(state.accommodation_d, [2.5, 5.0])
    np.testing.assert_allclose(state.focus_d, [2.5, 5.0])
    np.testing.assert_allclose(state.pupil_m, [0.005, 0.002])
    np.testing.assert_allclose(state.error_d(0.5), [0.5, 3.0])


@pytest.mark.parametrize(
    ("age", "expected_d"), [(0.0, 18.5), (20.0, 12.5), (60.0, 0.5), (90.0, 0.0)]
)
def test_the_range_of_accommodation_falls_with_age(age: float, expected_d: float) -> None:
    assert amplitude_d(age) == pytest.approx(expected_d)
    assert settled(np.ones(4), age_years=age).accommodation_d[0] == pytest.approx(expected_d)


def test_muscles_that_nobody_commands_leave_the_resting_focus_and_pupil() -> None:
    state = Lenses(LensesConfig(resting_pupil_mm=5.0)).state()
    np.testing.assert_allclose(state.accommodation_d, 1.5)
    np.testing.assert_allclose(state.pupil_m, 0.005)
    old = Lenses(LensesConfig(age_years=60.0)).state()
    np.testing.assert_allclose(old.accommodation_d, 0.5)  # all that is left


def test_a_hyperope_lacks_dioptres_that_glasses_give_back() -> None:
    np.testing.assert_allclose(settled(refraction_d=(2.0, -3.0)).focus_d, [0.5, 8.0])
    lens = settled(refraction_d=(2.0, -3.0), contact_lenses_d=(2.0, -3.0))
    np.testing.assert_allclose(lens.focus_d, [2.5, 5.0])
    # A spectacle lens of 5 D, 12 mm before the eye: 5 / (1 - 0.06).
    glasses = settled(spectacles_d=(5.0, -5.0)).focus_d
    np.testing.assert_allclose(glasses, [2.5 + 5.0 / 0.94, 5.0 - 5.0 / 1.06])
    assert LensesConfig(spectacles_d=(5.0, 0.0)).magnifications == pytest.approx((1 / 0.94, 1.0))


def test_drops_paralyse_the_lens_and_the_sphincter_of_one_eye() -> None:
    state = settled(cycloplegia=(1.0, 0.5))
    np.testing.assert_allclose(state.accommodation_d, [0.0, 2.5])
    np.testing.assert_allclose(state.pupil_m, [0.008, 0.005])


def test_a_pinhole_narrows_wider_pupils_alone() -> None:
    np.testing.assert_allclose(settled(pinhole_mm=(1.0, 3.0)).pupil_m, [0.001, 0.002])


def test_lenses_go_the_way_exponentially_and_pupils_more_slowly() -> None:
    lenses = Lenses(LensesConfig())
    lenses.settle(np.zeros(4))
    lenses.advance(COMMAND, 0.25)
    lens, pupil = 1.0 - math.exp(-1.0), 1.0 - math.exp(-0.25 / 0.3)
    state = lenses.state()
    np.testing.assert_allclose(state.accommodation_d, [2.5 * lens, 5.0 * lens])
    np.testing.assert_allclose(state.pupil_m, [0.008 - 0.003 * pupil, 0.008 - 0.006 * pupil])
    np.testing.assert_allclose(state.accommodation_d_s, np.array([2.5, 5.0]) * (1 - lens) / 0.25)
    np.testing.assert_allclose(state.pupil_m_s, np.array([-0.003, -0.006]) * (1 - pupil) / 0.3)
    halves = Lenses(LensesConfig())
    halves.settle(np.zeros(4))
    for _ in range(2):
        halves.advance(COMMAND, 0.125)
    np.testing.assert_allclose(halves.state().focus_d, state.focus_d)
    lenses.advance(COMMAND, math.inf)
    np.testing.assert_allclose(lenses.state().focus_d, [2.5, 5.0])
    np.testing.assert_array_equal(lenses.state().accommodation_d_s, 0.0)


def test_the_activation_for_an_accommodation_is_the_inverse() -> None:
    activation = ciliary_activation(3.0, 20.0)
    assert settled(np.full(4, activation)).accommodation_d[0] == pytest.approx(3.0)
    assert math.isnan(ciliary_activation(3.0, 60.0))


@pytest.mark.parametrize(
    ("activations", "message"),
    [
        (np.zeros(12), r"expected 4 activations of lenses and pupils, got shape \(12,\)"),
        (np.full(4, 1.1), "activations: expected 0 to 1"),
        (np.full(4, np.nan), "activations: expected 0 to 1"),
    ],
)
def test_bad_activations_are_refused(activations: np.ndarray, message: str) -> None:
    lenses = Lenses(LensesConfig())
    before = lenses.state()
    with pytest.raises(InputError, match=message):
        lenses.advance(activations, 0.1)
    np.testing.assert_array_equal(lenses.state().activations, before.activations)


def test_settings_out_of_range_are_refused() -> None:
    with pytest.raises(InputError, match="cycloplegia: expected 2 numbers, each 0 to 1"):
        LensesConfig(cycloplegia=(0.5,))
    with pytest.raises(InputError, match="resting_pupil_mm: expected 2 to 8 mm"):
        LensesConfig(resting_pupil_mm=9.0)
