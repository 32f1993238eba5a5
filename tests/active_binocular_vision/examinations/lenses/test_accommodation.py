"""Accommodation: slopes computed by hand, and what lenses and prisms change."""

import dataclasses

import numpy as np
import pytest

from active_binocular_vision.examinations.lenses.accommodation import (
    COVERED,
    LENSES,
    LENSES_D,
    PRISMS,
    PRISMS_PD,
    RESPONSE,
    AccommodationTraces,
    median,
    slope,
    slopes_of,
)
from active_binocular_vision.figures.examinations.lenses import accommodation_figure


def test_slopes_are_known_where_something_changes() -> None:
    x = np.array([[0.0, 1.0, 2.0], [0.0, 2.0, 4.0], [1.0, 1.0, 1.05]])
    y = np.array([[3.0, 3.7, 4.4], [0.0, 4.0, 8.0], [0.0, 9.0, 0.0]])
    slopes = slope(x, y)
    np.testing.assert_allclose(slopes, [0.7, 2.0, np.nan])
    np.testing.assert_allclose(slope(x[0], y), [0.7, 4.0, 0.0], atol=1e-12)
    assert median(slopes) == pytest.approx(1.35)
    assert median(slopes[1:]) is None


def _traces() -> AccommodationTraces:
    """Return one picture: response 0.5, to lenses 0.6, AC/A 2 PD/D, CA/C 0.1 D/PD.

    What asks for more than objects of training is not answered at all; lenses ask for 0 to 4 D.
    """
    lens_d, prism_pd = np.array(LENSES_D), np.array(PRISMS_PD)
    answered_d = np.array([0.0, 1.0, 2.0, 0.0, 0.0])
    accommodation_d = {
        RESPONSE: np.array([0.5, 1.0, 0.0]),
        LENSES: 0.8 + 0.6 * answered_d,
        COVERED: 1.0 + 0.5 * answered_d,
        PRISMS: 1.0 + 0.1 * prism_pd,
    }
    vergence_pd = {
        RESPONSE: np.zeros(3),
        LENSES: np.zeros(5),
        COVERED: 3.0 + answered_d,
        PRISMS: 11.0 + prism_pd,
    }
    return AccommodationTraces(
        {RESPONSE: np.array([1.0, 2.0, 4.0]), LENSES: lens_d, COVERED: lens_d, PRISMS: prism_pd},
        {test: of[None] for test, of in accommodation_d.items()},
        {test: of[None] for test, of in vergence_pd.items()},
        distance_d=2.0,
        trained_d=2.0,
        geometry_pd_d=5.6,
    )


def test_the_slopes_are_those_of_the_clinic() -> None:
    slopes = {name: float(of[0]) for name, of in slopes_of(_traces()).items()}
    assert slopes == pytest.approx(
        {
            "response": 0.5,
            "lens_response": 0.6,
            "stimulus_ac_a": 1.0,
            "response_ac_a": 2.0,
            "ca_c": 0.1,
        }
    )


def test_the_figure_draws_over_what_is_asked_for_and_what_follows() -> None:
    response, ac_a, ca_c = accommodation_figure(_traces()).axes
    identity, objects, lenses = (np.array(line.get_data()) for line in response.lines)
    np.testing.assert_allclose(identity, [[0.0, 4.0], [0.0, 4.0]])
    np.testing.assert_allclose(objects, [[1.0, 2.0, 4.0], [0.5, 1.0, 0.0]])
    np.testing.assert_allclose(lenses, [[0.0, 1.0, 2.0, 3.0, 4.0], [0.8, 1.4, 2.0, 0.8, 0.8]])
    for panel, geometry, seen in ((ac_a, 5.6, 2.0), (ca_c, 1.0 / 5.6, 0.1)):
        lines = [np.diff(np.array(line.get_data()))[:, 0] for line in panel.lines[:2]]
        assert [y / x for x, y in lines] == pytest.approx([geometry, seen])


def test_lenses_carry_over_from_one_part_to_the_next_and_settings_do_not(session_with) -> None:
    eyes = session_with("triad").eyes(0, 1.0)
    assert len(eyes.activations) == 12
    worn = {"lenses.cycloplegia": (1.0, 1.0)}
    assert eyes.look(2, settings=worn).lens_state.accommodation_d.tolist() == [0.0, 0.0]
    assert len(eyes.activations) == 16
    before_d = 12.5 * np.array(eyes.activations[12::2])
    moved = eyes.before(0.5)
    assert dataclasses.astuple(moved.look(1).lens_state)[1] == pytest.approx(before_d)
