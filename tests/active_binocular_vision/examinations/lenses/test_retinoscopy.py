"""Retinoscopy: lags that follow from refraction, lenses before the eyes and paralysed muscles."""

import pytest

from active_binocular_vision.examinations.lenses.retinoscopy import RETINOSCOPY
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.shown import Shown


@pytest.mark.parametrize(
    ("options", "lag_d"),
    [
        ({}, [2.5 + 2.0, 2.5 - 1.0]),
        ({"lenses_d": (1.0, 0.0), "distances_m": (0.5,)}, [2.0 + 2.0 - 1.0, 2.0 - 1.0]),
    ],
)
def test_with_cycloplegia_it_measures_the_refraction(run_of, options, lag_d) -> None:
    drops = {"lenses.refraction_d": (2.0, -1.0), "lenses.cycloplegia": (1.0, 1.0)}
    learners = FrozenLearners(run_of("triad"), settings=drops)
    found = RETINOSCOPY(learners, Shown(n_most=1), **options)
    assert [*found.measures()["summary"].values()] == pytest.approx(lag_d)
    # Drops widen the pupils.
    assert [row["pupil_mm"]["median"] for row in found.measures()["eyes"]] == [8.0, 8.0]
