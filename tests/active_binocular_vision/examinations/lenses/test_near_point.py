"""Near points of eyes that cannot focus, or turn, any nearer."""

import math

import numpy as np
import pytest

from active_binocular_vision.examinations.clinic.prisms import climb
from active_binocular_vision.examinations.contract.declared import NearPointOptions
from active_binocular_vision.examinations.lenses.near_point import (
    CONVERGENCE,
    NEAR_POINT,
    TESTS,
    NearPoint,
    near_point,
)
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.shown import Shown
from tests.active_binocular_vision.moved_eyes import moved_eyes
from tests.active_binocular_vision.perfect_eyes import perfect_eyes


@pytest.mark.parametrize(
    ("succeed", "found", "tried"),
    [
        ({0, 1, 2, 3}, (None, None), [0, 1, 2, 3]),
        ({0, 1, 3}, (None, None), [0, 1, 2, 3]),
        ({0}, (1, 0), [0, 1, 2, 3, 2, 1, 0]),
        (set(), (0, None), [0, 1, 2, 1, 0]),
    ],
)
def test_a_ladder_ends_where_three_steps_fail_and_goes_back(succeed, found, tried) -> None:
    steps: list[int] = []

    def try_step(i_step: int) -> bool:
        steps.append(i_step)
        return i_step in succeed

    assert climb(try_step, 3) == found
    assert steps == tried


@pytest.mark.parametrize("test", TESTS[1:])
def test_eyes_of_50_years_focus_as_near_as_their_lenses_allow(session_with, test) -> None:
    # 18.5 D less 0.3 D for each year, and half a dioptre of blur that is not seen.
    session = session_with("triad", **{"lenses.age_years": 50.0})
    options = NearPointOptions(first_d=3.5, nearest_d=5.0)
    with perfect_eyes():
        found = near_point(session, 0, test, options)
    assert found == NearPoint(4.0, 4.0)


def test_eyes_that_do_not_turn_fuse_at_their_first_distance_alone(session_with) -> None:
    options = NearPointOptions(nearest_d=1.5)
    with moved_eyes(lambda *_: np.zeros(1)):
        found = near_point(session_with("triad"), 0, CONVERGENCE, options)
    assert found == NearPoint(math.inf, math.inf)  # three steps are left, and four are needed
    options = NearPointOptions(nearest_d=2.0)
    with moved_eyes(lambda *_: np.zeros(1)):
        found = near_point(session_with("triad"), 0, CONVERGENCE, options)
    assert found == NearPoint(1.0, 1.0)


def test_near_points_are_told_in_centimetres_from_the_nearest_on(run_of) -> None:
    learners = FrozenLearners(run_of("triad"), settings={"lenses.age_years": 50.0})
    with perfect_eyes():
        found = NEAR_POINT(learners, Shown(n_most=1), first_d=3.5, nearest_d=5.0)
    convergence, *accommodation = found.measures()["tests"]
    assert (convergence["n_failed"], convergence["near_point_cm"]["median"]) == (0, None)
    assert [row["near_point_cm"]["median"] for row in accommodation] == [25.0] * 3
