"""Prisms: steps up and down, break and recovery."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from active_binocular_vision.examinations.clinic.prisms import (
    DIRECTIONS,
    Direction,
    PrismTraces,
    PrismTrial,
    prism_trial,
)
from active_binocular_vision.figures.examinations.clinic import prisms_figure
from active_binocular_vision.learners.session import NO_PRISM, Course, Prism
from tests.readable import assert_readable

BASE_OUT, BASE_UP, INCYCLO = DIRECTIONS[0], DIRECTIONS[2], DIRECTIONS[4]


class _Follower:
    """Eyes that follow a share of the demand up to a limit; beyond it only below a lower limit."""

    def __init__(
        self, direction: Direction, share: float, most_deg: float, regained_deg: float
    ) -> None:
        self._direction, self._share, self._most_deg = direction, share, most_deg
        self._regained_deg, self._has_lost = regained_deg, False

    def look(self, n_iterations: int, *, prism: Prism = NO_PRISM) -> Course:
        demand_deg = self._direction.sign * getattr(prism, self._direction.setting)
        self._has_lost = demand_deg > (self._regained_deg if self._has_lost else self._most_deg)
        response_deg = 0.0 if self._has_lost else self._share * demand_deg
        eyes_deg, seen_deg = np.zeros((2, n_iterations + 1, 3))
        eyes_deg[:, self._direction.i_error] = self._direction.error_sign * response_deg
        lag_deg = demand_deg - response_deg
        # A torsional disparity is none sideways or up.
        seen_deg[:, self._direction.i_error] = -self._direction.error_sign * lag_deg
        return Course(eyes_deg, seen_deg, np.zeros((n_iterations + 1, 2, 3)), np.zeros(12))


def _trial(direction: Direction, *eyes: float) -> PrismTrial:
    session: Any = SimpleNamespace(px_deg=0.22, eyes=lambda *_: _Follower(direction, *eyes))
    return prism_trial(session, 0, 1.0, direction)


def _measures(trial: PrismTrial) -> tuple[float, float]:
    return trial.break_deg, trial.recovery_deg


def test_fusion_is_lost_beyond_what_eyes_follow_and_regained_below() -> None:
    trial = _trial(BASE_OUT, 1.0, 3.0, 1.6)
    assert _measures(trial) == (3.5, 1.5)
    # Up to two steps beyond the break, and back to the recovery.
    assert trial.demand_deg.tolist() == [*np.arange(0.0, 4.6, 0.5), 4.0, 3.5, 3.0, 2.5, 2.0, 1.5]
    assert trial.response_deg[6] == pytest.approx(3.0)
    assert trial.lag_deg[7] == pytest.approx(3.5)


def test_a_lag_of_a_pixel_is_lost_fusion() -> None:
    # 90 % followed leave 0.1 of the demand, which is a pixel of 0.22 deg at 2.2.
    assert _measures(_trial(BASE_UP, 0.9, 99.0, 99.0)) == (2.25, 2.0)
    assert _trial(BASE_UP, 0.9, 99.0, 99.0).gain == pytest.approx(0.9)


@pytest.mark.parametrize(("share", "expected"), [(0.4, (0.5, 0.0)), (0.6, (math.inf, math.inf))])
def test_torsion_must_be_followed_by_half(share, expected) -> None:
    assert _measures(_trial(INCYCLO, share, 99.0, 99.0)) == expected


def test_fusion_that_is_never_regained() -> None:
    demand_deg = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 3.0, 2.0, 1.0, 0.0])
    fused = np.array([1, 1, 0, 0, 0, 0, 0, 0, 0], dtype=bool)
    trial = PrismTrial(demand_deg, demand_deg, np.zeros(9), fused)
    assert _measures(trial) == (2.0, -math.inf)


def test_fusion_lost_for_a_step_is_no_break() -> None:
    demand_deg = np.arange(7.0)
    fused = np.array([1, 1, 0, 0, 1, 1, 0], dtype=bool)
    trial = PrismTrial(demand_deg, demand_deg, np.zeros(7), fused)
    assert (trial.i_turn, trial.i_break, trial.i_recovery) == (6, None, None)


def test_gain_is_that_of_the_rising_steps() -> None:
    trial = PrismTrial(
        np.array([0.0, 1.0, 2.0, 1.0]),
        np.array([0.0, 0.5, 1.5, 9.0]),
        np.zeros(4),
        np.zeros(4, dtype=bool),
    )
    assert trial.gain == pytest.approx(3.5 / 5.0)
    assert trial.i_break == 0


def test_a_shorter_ladder_has_fewer_prisms() -> None:
    session: Any = SimpleNamespace(
        px_deg=0.22, eyes=lambda *_: _Follower(BASE_OUT, 1.0, 99.0, 99.0)
    )
    trial = prism_trial(session, 0, 1.0, BASE_OUT, 0.1)
    assert trial.demand_deg.tolist() == [0.0, 0.5, 1.0, 1.5, 2.0, 2.5]
    assert _measures(trial) == (math.inf, math.inf)


def test_the_pair_cannot_follow_a_vertical_prism(session_with) -> None:
    trial = prism_trial(session_with("pair"), 0, 2.0, BASE_UP)
    assert trial.demand_deg[trial.i_turn] > 0.0
    np.testing.assert_allclose(trial.response_deg, 0.0, atol=1e-2)


def test_the_figure_has_what_the_eyes_leave_of_the_demand_at_each_distance() -> None:
    distances_m = (0.5, 6.0)
    trials = {
        (direction.name, distance_m): [_trial(direction, 0.9, 4.0, 2.0)]
        for direction in DIRECTIONS
        for distance_m in distances_m
    }
    figure = prisms_figure(PrismTraces(0.22, distances_m, trials))
    assert len(figure.axes) == 3 * len(distances_m)
    for axes in figure.axes:
        demand_deg, lag_deg = (np.asarray(a) for a in axes.lines[0].get_data())
        followed = demand_deg <= 4.0
        np.testing.assert_allclose(lag_deg[followed], 0.1 * demand_deg[followed], atol=1e-9)
    assert_readable(figure)
