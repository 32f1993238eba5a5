import numpy as np
import pytest

from eye_plant.mechanics.metabolics import MetabolicTerms, metabolic_terms
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from eye_plant.mechanics.oculomotor import Oculomotor
from eye_plant.mechanics.parameters import Energetics


def one_kilogram(energetics: Energetics = Energetics(), **changes: float) -> MetabolicTerms:  # noqa: B008
    """Terms of a muscle of 1 kg, l_opt 0.1 m, v_max 10 / s; resting at l_opt unless changed."""
    state = {
        "excitation": 0.0,
        "activation": 0.0,
        "length": 1.0,
        "velocity_per_s": 0.0,
        "isometric_force": 1.0,
        "contractile_force_n": 0.0,
    }
    return metabolic_terms(
        **(state | changes),
        optimal_length_m=0.1,
        max_velocity_per_s=10.0,
        mass_kg=1.0,
        energetics=energetics,
    )


FULL = {"excitation": 1.0, "activation": 1.0}
LONG = {"length": 1.1, "isometric_force": 0.5}


@pytest.mark.parametrize(
    ("changes", "term", "expected_w"),
    [
        (FULL, "total_w", 127.4),
        (FULL | {"energetics": Energetics(scaling=1.5)}, "total_w", 191.1),
        ({}, "floor_w", 1.0),
        ({}, "total_w", 1.0),
        # Above the optimal length maintenance falls with the isometric force, below it does not.
        (FULL | {"length": 1.2, "isometric_force": 0.5}, "activation_maintenance_w", 0.7 * 127.4),
        (FULL | {"length": 0.8, "isometric_force": 0.5}, "activation_maintenance_w", 127.4),
        # A falling activation is charged half-way, A = 0.3; a rising one by its excitation.
        ({"excitation": 0.2, "activation": 0.4}, "activation_maintenance_w", 127.4 * 0.3**0.6),
        ({"excitation": 0.4, "activation": 0.2}, "activation_maintenance_w", 127.4 * 0.4**0.6),
        # a_slow = 100 / (10 / 2.5) = 25, a_fast = 153 / 10 = 15.3; v = -2:
        # slow 50 * 0.2 + fast 30.6 * 0.8 = 34.48, times A^2 = 0.25.
        (
            {"excitation": 0.5, "activation": 0.5, "velocity_per_s": -2.0},
            "shortening_lengthening_w",
            0.25 * 34.48,
        ),
        # Slow shortening saturates: 25 * 8 = 200 -> 100, * 0.2; fast 15.3 * 8 * 0.8.
        (FULL | {"velocity_per_s": -8.0}, "shortening_lengthening_w", 20.0 + 97.92),
        # Lengthening: 4 * 25 * 0.5 * A = 0.2, above l_opt times F_iso = 0.5.
        (
            {"excitation": 0.2, "activation": 0.2, "velocity_per_s": 0.5} | LONG,
            "shortening_lengthening_w",
            0.2 * 50.0 * 0.5,
        ),
        # Work: 3 N at 2 l_opt / s = 0.2 m / s.
        ({"contractile_force_n": 3.0, "velocity_per_s": -2.0}, "work_w", 0.6),
        ({"contractile_force_n": 3.0, "velocity_per_s": 2.0}, "work_w", -0.6),
    ],
)
def test_terms_by_hand(changes, term, expected_w):
    assert getattr(one_kilogram(**changes), term) == pytest.approx(expected_w)


def test_k17_cost_is_the_power_law_with_a_floor_of_the_charged_activation():
    eyes = Oculomotor(MechanicsConfig())
    for medial, lateral in ((0.0, 0.0), (0.004, 0.3), (0.1, 0.02), (0.2, 0.1), (1.0, 1.0)):
        eyes.settle(eyes.activations_from(medial, lateral))
        state = eyes.state()
        expected_w = 2.0 * (
            2.2295 * max(medial, 0.005) ** 0.6 + 2.0295 * max(lateral, 0.005) ** 0.6
        )
        assert eyes.horizontal_metabolic_rate_w() == pytest.approx(expected_w, rel=1e-3)
        np.testing.assert_array_equal(state.activations[:2], [medial, lateral])


@pytest.mark.parametrize("parameter_set", ["k17", "anatomical"])
def test_the_settled_rate_is_the_sum_of_the_terms_at_rest(parameter_set):
    eyes = Oculomotor(MechanicsConfig(parameter_set=parameter_set))
    for medial, lateral in ((0.0, 0.0), (0.6, 0.0), (0.05, 0.2)):
        eyes.settle(eyes.activations_from(medial, lateral))
        state = eyes.state()
        terms = eyes.musculature.metabolic_terms(
            state.activations,
            state.activations,
            state.lengths_m,
            state.velocities_m_s,
            state.forces_n,
        )
        np.testing.assert_allclose(terms.total_w, state.metabolic_rate_w, rtol=1e-12)


def test_mean_rate_of_a_period_in_which_nothing_happens_is_the_settled_rate():
    eyes = Oculomotor(MechanicsConfig(parameter_set="anatomical"))
    activations = eyes.activations_from(0.1, 0.05)
    eyes.settle(activations)
    eyes.step(activations)
    state = eyes.state()
    np.testing.assert_allclose(state.mean_metabolic_rate_w, state.metabolic_rate_w, rtol=1e-6)


def test_the_mean_rate_stays_that_of_the_state_s_own_period():
    eyes = Oculomotor(MechanicsConfig())
    eyes.step(eyes.activations_from(0.2, 0.0))
    state, expected_w = eyes.state(), eyes.metabolic_trace().total_w.mean(axis=0)
    eyes.step(eyes.activations_from(0.0, 0.1))
    assert not np.array_equal(eyes.state().mean_metabolic_rate_w, expected_w)
    np.testing.assert_array_equal(state.mean_metabolic_rate_w, expected_w)


def test_the_trace_begins_with_the_muscles_at_rest_and_charges_what_they_still_hold():
    """By hand: a = 0.2, u = 0 and no motion, so A = 0.1 (Umberger 2003, eq. 6) and heat ~ A^0.6."""
    eyes = Oculomotor(MechanicsConfig())
    eyes.settle(eyes.activations_from(0.2, 0.0))
    settled_w = eyes.state().metabolic_rate_w[0]
    eyes.step(eyes.activations_from(0.0, 0.0))
    terms = eyes.metabolic_trace()
    assert terms.activation_maintenance_w[0, 0] == pytest.approx(0.5**0.6 * settled_w)
    assert terms.work_w[0, 0] == pytest.approx(0.0, abs=1e-12)
    # One step of a time constant later a = 0.2 / e: the heat is less by e^-0.6.
    assert eyes.model.opt.timestep == pytest.approx(0.01)
    later = terms.activation_maintenance_w[1, 0] / terms.activation_maintenance_w[0, 0]
    assert later == pytest.approx(np.exp(-0.6))


def test_moving_costs_work_and_heat_that_add_up_to_the_mean_rate():
    eyes = Oculomotor(MechanicsConfig())
    eyes.settle(eyes.activations_from(0.0, 0.05))
    eyes.step(eyes.activations_from(0.2, 0.0))
    terms = eyes.metabolic_trace()
    assert terms.work_w[:, 0].mean() > 0.0  # the medial rectus shortens
    assert terms.work_w[:, 1].mean() < 0.0  # the lateral rectus, letting go, is stretched
    assert terms.shortening_lengthening_w[:, 0].max() > 0.0
    total_w = (
        terms.activation_maintenance_w
        + terms.shortening_lengthening_w
        + terms.floor_w
        + terms.work_w
    )
    np.testing.assert_allclose(eyes.state().mean_metabolic_rate_w, total_w.mean(axis=0))
