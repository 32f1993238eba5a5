"""sweeps/costs.py: the cheapest activations that hold an eye, against slower searches."""

import importlib.util
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from eye_plant.mechanics.mujoco_model import MechanicsConfig
from eye_plant.mechanics.oculomotor import Oculomotor

SCRIPT = Path(__file__).parents[2] / "sweeps" / "costs.py"
GAZE_DEG = (10.0, -15.0)


@pytest.fixture(scope="module")
def costs() -> Any:
    spec = importlib.util.spec_from_file_location("costs", SCRIPT)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def eye(costs: Any) -> Any:
    return costs.Eye()


@pytest.fixture(scope="module")
def held(eye: Any) -> Any:
    return eye.held(*GAZE_DEG)


def test_the_cheapest_activations_hold_the_gaze(costs: Any, eye: Any, held: Any) -> None:
    eyes = Oculomotor(MechanicsConfig(parameter_set="anatomical", moves="at_once"))
    for cost, floor_gf, is_concave in costs.costs(eye.tonic).values():
        low = held.lowest(floor_gf)
        a = costs.cheapest(held, cost, low, is_concave=is_concave)
        assert a is not None
        assert (a >= low).all()
        assert held.tension_gf(a).min() >= floor_gf - 1e-6
        eyes.settle(np.concatenate([a, eyes.tonic_activations[6:]]))
        assert np.degrees(eyes.state().eye_angles_rad[0, :2]) == pytest.approx(GAZE_DEG, abs=1e-3)
        assert eyes.state().forces_n[:6] == pytest.approx(
            held.active_n * a + held.passive_n, abs=1e-4
        )


def test_nothing_that_holds_the_gaze_is_cheaper(costs: Any, eye: Any, held: Any) -> None:
    low = held.lowest(0.0)
    corners = np.array([*costs.corners(held, low)])
    # What lies between corners is balanced, too.
    weights = np.random.default_rng(0).dirichlet(np.ones(len(corners)) / 4.0, 2000)
    others = weights @ corners
    assert np.abs([held.missed(a) for a in others]).max() < 1e-9
    for cost, floor_gf, is_concave in costs.costs(eye.tonic).values():
        if floor_gf == 0.0:
            best = cost(held, costs.cheapest(held, cost, low, is_concave=is_concave))
            assert best <= min(cost(held, a) for a in (*others, *corners)) + 1e-12


def test_endpoint_variance_is_that_of_eyes_with_noise(costs: Any, held: Any) -> None:
    a = costs.cheapest(held, costs.squares, held.lowest(5.0), is_concave=False)
    eyes = Oculomotor(MechanicsConfig(parameter_set="anatomical", moves="at_once"))
    noise, draw = 1e-3, np.random.default_rng(1)
    ends = []
    for _ in range(400):
        shaken = a * (1.0 + noise * draw.standard_normal(6))
        eyes.rest(np.concatenate([shaken, eyes.tonic_activations[6:]]))
        ends.append(eyes.data.qpos[:2].copy())
    expected = noise**2 * costs.endpoint_variance(held, a)
    assert np.var(ends, axis=0).sum() == pytest.approx(expected, rel=0.25)


def test_reciprocity_and_yokes_of_activations_that_are_known(costs: Any) -> None:
    places = np.array(costs.gazes(12.5))
    activations = np.full((25, 6), np.nan)
    # One relaxes as the other contracts, by half as much, about a tonic level.
    turn = places[:, 0] / 1000.0
    for i in (0, 2, 4):
        activations[:, i], activations[:, i + 1] = 0.1 + turn, 0.1 - turn
    row = costs.measures(places, activations, 100.0 * activations)
    assert (row["gazes"], row["both active"], row["active muscles"]) == (25, 1.0, 6.0)
    assert row["medial rectus ahead / gf"] == pytest.approx(10.0)
    assert row["slope, horizontal recti, 25 deg"] == pytest.approx(-1.0)
    assert np.isnan(row["slope, vertical recti, 25 deg"]), "they do not vary along their meridian"
    assert row["correlation, medial rectus and lateral rectus"] == pytest.approx(1.0)
    assert row["slope, medial rectus and lateral rectus"] == pytest.approx(1.0)
    assert row["difference over mean, medial rectus and lateral rectus"] == pytest.approx(0.0)
