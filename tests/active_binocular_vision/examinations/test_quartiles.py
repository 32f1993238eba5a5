"""Quartiles over pictures, and prism dioptres."""

import math

import pytest

from active_binocular_vision.examinations.quartiles import (
    censored_quartiles_of,
    in_prism_dioptres,
    quartiles_of,
)


def test_quartiles_are_linear_between_values() -> None:
    expected = {"lower_quartile": 1.75, "median": 2.5, "upper_quartile": 3.25}
    assert quartiles_of([4.0, 1.0, 3.0, 2.0]) == pytest.approx(expected)


def test_a_quartile_beyond_what_was_tried_is_none() -> None:
    found = censored_quartiles_of([3.0, math.inf, 5.0, math.inf, 4.0])
    assert found == {"lower_quartile": 4.0, "median": 5.0, "upper_quartile": None}
    assert censored_quartiles_of([-math.inf] * 3)["median"] is None


def test_prism_dioptres_are_cm_at_one_metre() -> None:
    quartiles_deg = {"lower_quartile": -1.0, "median": None, "upper_quartile": 45.0}
    assert in_prism_dioptres(quartiles_deg) == {
        "lower_quartile": pytest.approx(-1.7455, abs=1e-4),
        "median": None,
        "upper_quartile": pytest.approx(100.0),
    }
