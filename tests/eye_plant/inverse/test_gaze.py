"""Activations for a gaze, against the settled eyes; the least cost, against what others found."""

from dataclasses import astuple

import numpy as np
import pytest
from numpy.typing import NDArray

from eye_plant import GazeInverse
from eye_plant.gaze_error import gaze_error, target_place_deg
from eye_plant.inverse.gaze import ERRORS, LEFT_SIGHT, TURNED_ANGLES
from eye_plant.inverse.least_cost import cost_of_vergence
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from eye_plant.mechanics.oculomotor import Oculomotor
from eye_plant.turns import NO_TURNS_DEG, turned
from eye_plant.vergence import desired_vergence_deg
from lockstep import ALL_MUSCLES, COMMAND_SPACES, HORIZONTAL_RECTI, PAIR, InputError

ANATOMICAL = MechanicsConfig(parameter_set="anatomical")
FUSED = dict.fromkeys(ERRORS, 0.0)
Array = NDArray[np.float64]


def _inverse(space: str, highest: float = 0.2, config: MechanicsConfig = ANATOMICAL) -> GazeInverse:
    n = len(COMMAND_SPACES[space].names)
    return GazeInverse(config, COMMAND_SPACES[space], [0.0] * n, [highest] * n)


def _settled_deg(activations: Array, distance_m: float) -> dict[str, float]:
    """Slow oracle: the errors of eyes that are put there, and where both look."""
    eyes = Oculomotor(ANATOMICAL)
    eyes.settle(activations)
    error = gaze_error(eyes.eye_positions_m(), eyes.eye_rotations(), distance_m)
    left, right = np.degrees(eyes.state().eye_angles_rad)
    return {
        "horizontal": error.horizontal_deg,
        "vertical": error.vertical_deg,
        "torsional": error.torsional_deg,
        "version": (left[0] - right[0]) / 2.0,
        "elevation": (left[1] + right[1]) / 2.0,
    }


@pytest.mark.parametrize("space", [HORIZONTAL_RECTI, ALL_MUSCLES])
def test_eyes_at_rest_have_the_wanted_gaze(space: str) -> None:
    draw, inverse = np.random.default_rng(1), _inverse(space)
    largest = {"horizontal": 3, "vertical": 1.5, "torsional": 4, "version": 5, "elevation": 5}
    for _ in range(20):
        wanted = {name: draw.uniform(-1, 1) * largest[name] for name in TURNED_ANGLES[space]}
        aside = draw.normal(0.0, 0.03, len(COMMAND_SPACES[space].names))
        distance_m = draw.uniform(0.5, 6.0)
        found = inverse.activations(wanted, distance_m, aside)
        settled = _settled_deg(found, distance_m)
        assert {name: settled[name] for name in wanted} == pytest.approx(wanted, abs=1e-5)
        assert found.min() >= 0.0
        assert found[COMMAND_SPACES[space].indices].max() <= 0.2


def test_the_place_aside_is_kept_but_for_what_the_gaze_needs() -> None:
    inverse = _inverse(ALL_MUSCLES)
    at_tonic, aside = (
        inverse.activations(FUSED, 1.0, np.full(12, change)) for change in (0.0, 0.02)
    )
    # All muscles pull harder by as much; that turns the eyes by little, which is taken back.
    assert aside - at_tonic == pytest.approx(np.full(12, 0.02), abs=0.01)
    assert (aside > at_tonic).all()


def test_turned_cameras_count_in_the_wanted_errors_and_their_least_cost() -> None:
    # A prism of 5 deg, base out, before the right eye: correct eyes converge by 5 deg more.
    turns_deg = ((0.0, 0.0, 0.0), (-5.0, 0.0, 0.0))
    space = COMMAND_SPACES[ALL_MUSCLES]
    inverse = GazeInverse(ANATOMICAL, space, [0.0] * 12, [0.2] * 12, turns_deg)
    settled = _settled_deg(inverse.activations(FUSED, 1.0, np.zeros(12)), 1.0)
    assert settled["horizontal"] == pytest.approx(-5.0, abs=1e-5)
    lowest = (0.0,) * 12
    plain, with_prism = (
        cost_of_vergence(ANATOMICAL, ALL_MUSCLES, lowest, *turns) for turns in ((), (turns_deg,))
    )
    assert with_prism.least_w(2.0) > 1.1 * plain.least_w(2.0)
    assert with_prism.least_w(2.0) == pytest.approx(plain.least_w(7.0), rel=0.05)


def test_a_gaze_out_of_reach_is_refused_by_its_angle() -> None:
    with pytest.raises(InputError, match=r"reach a version of 40\.00 deg with a horizontal"):
        _inverse(ALL_MUSCLES).activations(FUSED | {"version": 40.0}, 1.0, np.zeros(12))


def test_the_least_cost_leaves_one_muscle_of_each_pair_silent() -> None:
    inverse = _inverse(ALL_MUSCLES)
    least = inverse.least(FUSED, 0.5)
    settled = _settled_deg(least.activations, 0.5)
    assert {name: settled[name] for name in ERRORS} == pytest.approx(FUSED, abs=1e-3)
    pairs = least.activations.reshape(6, 2)
    assert pairs.min(axis=1) == pytest.approx(0.0, abs=1e-4)
    # One medial rectus does it, gaze aside.
    assert least.metabolic_rate_w == pytest.approx(0.0175, abs=2e-4)
    assert least.activations.max() == pytest.approx(0.0147, abs=2e-4)


def test_nothing_that_was_tried_costs_less_than_the_least() -> None:
    inverse, eyes = _inverse(ALL_MUSCLES), Oculomotor(ANATOMICAL)
    least = inverse.least(FUSED, 1.0)
    draw = np.random.default_rng(2)
    for _ in range(30):
        aside = draw.normal(-0.02, 0.02, 12)
        eyes.settle(inverse.activations(FUSED, 1.0, aside))
        assert eyes.settled_metabolic_rate_w().sum() > least.metabolic_rate_w


@pytest.mark.parametrize("space", [HORIZONTAL_RECTI, ALL_MUSCLES])
def test_the_table_of_least_costs_is_that_of_the_inverse(space: str) -> None:
    n = len(COMMAND_SPACES[space].names)
    table = cost_of_vergence(ANATOMICAL, space, (0.0,) * n)
    wanted = {name: 0.0 for name in ERRORS if name in TURNED_ANGLES[space]}
    # 1.604 deg is the vergence at 2 m.
    expected_w = _inverse(space, 1.0).least(wanted, 2.0).metabolic_rate_w
    assert table.least_w(1.6041) == pytest.approx(expected_w, rel=0.01)


def test_a_floor_costs_more() -> None:
    free, floored = (cost_of_vergence(ANATOMICAL, PAIR, (low, low)) for low in (0.0, 0.02))
    assert floored.least_w(3.0) > free.least_w(3.0)


def test_what_no_muscle_reaches_is_refused() -> None:
    config = MechanicsConfig(parameter_set="anatomical", strength=(0.0,) * 12)
    with pytest.raises(InputError, match="no activations of these muscles give a vergence of 4 "):
        cost_of_vergence(config, ALL_MUSCLES, (0.0,) * 12).least_w(4.0)


@pytest.mark.parametrize("turns_deg", [NO_TURNS_DEG, ((2.0, 1.0, 0.0), (-5.0, 0.0, 0.0))])
@pytest.mark.parametrize("target_deg", [(8.0, 8.0), (-8.0, 0.0), (0.5, -7.0)])
def test_the_least_cost_at_a_target_is_of_eyes_that_look_there(target_deg, turns_deg) -> None:
    lowest, distance_m = (0.0,) * 12, 2.0
    vergence_deg = desired_vergence_deg(distance_m, ANATOMICAL.baseline_m)
    cost = cost_of_vergence(ANATOMICAL, ALL_MUSCLES, lowest, turns_deg)
    space = COMMAND_SPACES[ALL_MUSCLES]
    inverse = GazeInverse(ANATOMICAL, space, lowest, [1.0] * 12, turns_deg)
    least = inverse.least(FUSED | dict(zip(LEFT_SIGHT, target_deg, strict=True)), distance_m)
    eyes = Oculomotor(ANATOMICAL)
    eyes.settle(least.activations)
    cameras = turned(eyes.eye_rotations(), turns_deg)
    assert target_place_deg(cameras[0], *target_deg) == pytest.approx((0.0, 0.0), abs=2e-3)
    error = gaze_error(eyes.eye_positions_m(), cameras, distance_m)
    assert astuple(error) == pytest.approx((0.0, 0.0, 0.0), abs=2e-3)
    # Fewer first weights find as little, and gaze that is free costs less.
    assert cost.least_w(vergence_deg, target_deg) == pytest.approx(least.metabolic_rate_w, rel=5e-3)
    assert cost.least_w(vergence_deg) < 0.8 * least.metabolic_rate_w


def test_the_least_cost_at_a_target_out_of_reach_is_not_known() -> None:
    cost = cost_of_vergence(ANATOMICAL, ALL_MUSCLES, (0.0,) * 12)
    assert np.isnan(cost.least_w(1.6, (0.0, 80.0)))
