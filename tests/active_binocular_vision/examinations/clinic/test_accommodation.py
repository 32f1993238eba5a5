"""Accommodation: slopes computed by hand, and what lenses and prisms change."""

import dataclasses
import math

import numpy as np
import pytest

from active_binocular_vision.examinations.clinic.accommodation import (
    slope,
    summary_of,
)
from active_binocular_vision.examinations.contract.measure import prism_dioptres


def test_a_slope_is_the_median_over_pictures_in_which_something_changes() -> None:
    x = np.array([[0.0, 1.0, 2.0], [0.0, 1.0, 2.0], [0.0, 2.0, 4.0], [1.0, 1.0, 1.05]])
    y = np.array([[1.0, 1.5, 2.0], [3.0, 3.7, 4.4], [0.0, 4.0, 8.0], [0.0, 9.0, 0.0]])
    assert slope(x, y) == pytest.approx(0.7)
    assert slope(x[2:], y[2:]) is None


def test_the_slopes_are_those_of_the_clinic() -> None:
    # Of one picture: half the response, lenses made up for by 0.6, 2 deg per dioptre, and 0.3 D
    # per degree.
    lenses_d = (-1.0, 1.0)
    accommodation_d = np.array([1.6, 0.4])
    found = {
        "response": ([0.5, 2.0], np.array([[[0.5, 2.0], [1.25, 5.0]]])),
        "lens": (lenses_d, np.stack([accommodation_d, [3.0, 3.0]], axis=-1)[None]),
        "lens, right eye covered": (
            lenses_d,
            np.stack([accommodation_d, [4.2, 1.8]], axis=-1)[None],
        ),
        "prism, pinholes": (lenses_d, np.array([[[1.0, 2.0], [1.6, 4.0]]])),
    }
    two_deg_pd, four_deg_pd = map(prism_dioptres, (2.0, 4.0))
    assert two_deg_pd == pytest.approx(100.0 * math.tan(math.radians(2.0)))
    ac_a = (prism_dioptres(4.2) - prism_dioptres(1.8)) / 1.2  # type: ignore[operator]
    ca_c = 0.6 / (four_deg_pd - two_deg_pd)  # type: ignore[operator]
    assert dataclasses.astuple(summary_of(found)) == pytest.approx((0.5, -0.6, ac_a, ca_c))


def test_lenses_carry_over_from_one_part_to_the_next_and_settings_do_not(session_with) -> None:
    eyes = session_with("triad").eyes(0, 1.0)
    assert len(eyes.activations) == 12
    worn = {"lenses.cycloplegia": (1.0, 1.0)}
    assert eyes.look(2, settings=worn).accommodation_d.tolist() == [0.0, 0.0]
    assert len(eyes.activations) == 16
    before_d = 12.5 * np.array(eyes.activations[12::2])
    np.testing.assert_allclose(eyes.look(1).accommodation_d, before_d)
