from dataclasses import fields

import mujoco
import numpy as np
import pytest

from eye_plant.mechanics.mujoco_model import build_spec
from eye_plant.mechanics.oculomotor import MechanicsConfig, Oculomotor, OculomotorState
from lockstep import MUSCLE_NAMES

SETS = ("k17", "anatomical")
LEFT, RIGHT = 0, 1
ADDUCTION, ELEVATION, INTORSION = 0, 1, 2


def eyes_with(**changes) -> Oculomotor:
    return Oculomotor(MechanicsConfig(**changes))


def angles_deg(eyes: Oculomotor) -> np.ndarray:
    return np.degrees(eyes.state().eye_angles_rad)


def all_but(default: float, **values: float) -> tuple[float, ...]:
    """Twelve numbers: the default except for the muscles named."""
    return tuple(values.get(name, default) for name in MUSCLE_NAMES)


def rested_deg(config: MechanicsConfig, activations: np.ndarray) -> np.ndarray:
    """Slow oracle of the static equilibrium: simulate until nothing has moved for long."""
    model = build_spec(config).compile()
    model.opt.timestep = 1e-3
    data = mujoco.MjData(model)
    data.ctrl[:] = data.act[:] = activations
    mujoco.mj_step(model, data, 8000)
    assert np.abs(data.qvel).max() < 1e-9
    return np.degrees(data.qpos.reshape(2, 3))


@pytest.mark.parametrize("parameter_set", SETS)
def test_settling_finds_where_a_long_simulation_comes_to_rest(parameter_set):
    eyes = eyes_with(parameter_set=parameter_set)
    for medial, lateral in ((0.2, 0.0), (0.03, 0.1), (0.0, 0.4)):
        activations = eyes.activations_from(medial, lateral)
        activations[2] += 0.1  # the left superior rectus: all axes take part
        eyes.settle(activations)
        np.testing.assert_allclose(
            angles_deg(eyes), rested_deg(eyes.config, activations), atol=1e-6
        )


@pytest.mark.parametrize("parameter_set", SETS)
def test_steps_inside_the_limits_end_at_the_static_equilibrium(parameter_set):
    stepping, settling = (
        eyes_with(parameter_set=parameter_set),
        eyes_with(parameter_set=parameter_set),
    )
    generator = np.random.default_rng(0)
    for _ in range(30):
        activations = stepping.activations_from(*generator.uniform(0.0, (0.2, 0.1)))
        stepping.step(activations)
        settling.settle(activations)
        np.testing.assert_allclose(angles_deg(stepping), angles_deg(settling), atol=1e-6)
        np.testing.assert_allclose(stepping.state().activations, activations, atol=1e-12)
        assert np.abs(stepping.state().eye_velocities_rad_s).max() == 0.0


def test_k17_periods_are_long_enough_for_the_simulated_eyes_to_come_to_rest():
    free, settled = eyes_with(), eyes_with()
    generator = np.random.default_rng(0)
    for _ in range(20):
        activations = free.activations_from(*generator.uniform(0.0, (0.2, 0.1)))
        free.advance(activations, free.control_period_s)
        settled.settle(activations)
        np.testing.assert_allclose(angles_deg(free), angles_deg(settled), atol=0.02)
        np.testing.assert_allclose(free.state().activations, activations, atol=1e-6)


@pytest.mark.parametrize("parameter_set", SETS)
def test_a_step_depends_on_what_came_since_settling_only(parameter_set):
    used, fresh = eyes_with(parameter_set=parameter_set), eyes_with(parameter_set=parameter_set)
    for medial in (0.2, 0.0, 0.13):
        used.step(used.activations_from(medial, 0.05))
    for eyes in (used, fresh):
        eyes.settle(eyes.activations_from(0.1, 0.02))
        eyes.step(eyes.activations_from(0.02, 0.07))
    for name in (field.name for field in fields(OculomotorState)):
        value, expected = (getattr(eyes.state(), name) for eyes in (used, fresh))
        if callable(value):
            value, expected = value(), expected()
        np.testing.assert_array_equal(value, expected, err_msg=name)


@pytest.mark.parametrize("parameter_set", SETS)
def test_each_muscle_moves_its_own_eye_alone(parameter_set):
    eyes = eyes_with(parameter_set=parameter_set)
    rest = angles_deg(eyes)
    for i, name in enumerate(MUSCLE_NAMES):
        activations = eyes.tonic_activations
        activations[i] += 0.1
        eyes.settle(activations)
        side = LEFT if name.startswith("left") else RIGHT
        np.testing.assert_allclose(angles_deg(eyes)[1 - side], rest[1 - side], atol=1e-9)
        assert np.abs(angles_deg(eyes)[side] - rest[side]).max() > 0.5, name


@pytest.mark.parametrize("parameter_set", SETS)
def test_both_eyes_turn_alike_with_the_same_activations(parameter_set):
    eyes = eyes_with(parameter_set=parameter_set)
    generator = np.random.default_rng(0)
    for _ in range(10):
        eyes.settle(np.tile(generator.uniform(0.0, 0.3, 6), 2))
        np.testing.assert_allclose(angles_deg(eyes)[LEFT], angles_deg(eyes)[RIGHT], atol=1e-6)


def test_k17_horizontal_recti_turn_the_eyes_about_the_vertical_only():
    eyes = eyes_with()
    for medial, lateral in ((0.2, 0.0), (0.0, 0.1), (0.7, 0.3)):
        eyes.settle(eyes.activations_from(medial, lateral))
        np.testing.assert_allclose(angles_deg(eyes)[:, ELEVATION:], 0.0, atol=1e-6)


def test_k17_gaze_at_rest_and_its_slopes():
    # OpenEyeSim: 0.498 deg at rest, +3.77 deg per 0.1 medial, -4.09 deg per 0.1 lateral
    eyes = eyes_with()
    gaze = {}
    for medial, lateral in ((0.0, 0.0), (0.1, 0.0), (0.0, 0.1)):
        eyes.settle(eyes.activations_from(medial, lateral))
        gaze[medial, lateral] = angles_deg(eyes)[LEFT, ADDUCTION]
    assert gaze[0.0, 0.0] == pytest.approx(0.498, abs=0.05)
    assert gaze[0.1, 0.0] - gaze[0.0, 0.0] == pytest.approx(3.77, abs=0.2)
    assert gaze[0.0, 0.1] - gaze[0.0, 0.0] == pytest.approx(-4.09, abs=0.2)


def test_anatomical_eyes_look_straight_ahead_at_tonic_level_under_tension():
    eyes = eyes_with(parameter_set="anatomical")
    np.testing.assert_allclose(angles_deg(eyes), 0.0, atol=0.01)
    recti_gf = eyes.state().forces_n[[0, 1, 2, 3]] / 9.80665e-3
    assert recti_gf.min() >= 8.0
    assert recti_gf.max() <= 15.0


def test_unnamed_muscles_keep_their_tonic_level():
    eyes = eyes_with(parameter_set="anatomical")
    activations = eyes.activations_from(0.3, 0.0)
    np.testing.assert_array_equal(activations[2:6], eyes.tonic_activations[2:6])
    assert activations[0] == activations[6] == 0.3
    assert activations[1] == activations[7] == 0.0
    assert eyes.tonic_activations.min() > 0.0


def test_free_running_eyes_are_under_way_before_they_arrive():
    eyes = eyes_with(parameter_set="anatomical")
    activations = eyes.activations_from(0.3, 0.0)
    eyes.advance(activations, 0.02)
    state = eyes.state()
    assert 0.5 < np.degrees(state.eye_angles_rad[LEFT, ADDUCTION]) < 10.0
    assert state.eye_velocities_rad_s[LEFT, ADDUCTION] > 0.5
    assert state.velocities_m_s[0] < 0.0 < state.velocities_m_s[1]


@pytest.mark.parametrize("parameter_set", SETS)
@pytest.mark.parametrize("duration_s", [1e-3, 5e-3, 1.0 / 60.0, 0.1])
def test_free_running_eyes_spend_the_time_that_is_asked_for(parameter_set, duration_s):
    eyes, used = eyes_with(parameter_set=parameter_set), eyes_with(parameter_set=parameter_set)
    activations = eyes.activations_from(0.3, 0.0)
    for _ in range(3):
        eyes.advance(activations, duration_s)
    assert eyes.data.time == pytest.approx(3 * duration_s, rel=1e-12)
    # And leave the steps of the lockstep as they are.
    eyes.settle(used.tonic_activations)
    for each in (eyes, used):
        each.step(activations)
    np.testing.assert_array_equal(
        eyes.state().mean_metabolic_rate_w, used.state().mean_metabolic_rate_w
    )


def test_a_scaled_timestep_and_period_are_kept():
    eyes = eyes_with(control_period_s=0.1, timestep_s=0.002)
    assert eyes.control_period_s == pytest.approx(0.1)
    assert eyes.model.opt.timestep == pytest.approx(0.002)


def test_states_share_no_memory():
    eyes = eyes_with()
    before = eyes.state()
    kept = before.eye_angles_rad.copy()
    eyes.step(eyes.activations_from(0.2, 0.0))
    np.testing.assert_array_equal(before.eye_angles_rad, kept)


@pytest.mark.parametrize(
    ("activations", "message"),
    [
        (np.zeros(11), "expected 12 activations, got shape"),
        (np.full(12, 1.1), "expected 0 to 1"),
        (np.full(12, np.nan), "expected 0 to 1"),
    ],
)
def test_bad_activations_are_refused(activations, message):
    eyes = eyes_with()
    with pytest.raises(ValueError, match=message):
        eyes.step(activations)


# Lesions and surgery ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("side", "name"), [(LEFT, "left_medial_rectus"), (RIGHT, "right_medial_rectus")]
)
def test_a_paralysed_medial_rectus_leaves_its_eye_where_silence_would(side, name):
    healthy = eyes_with()
    paralysed = eyes_with(strength=all_but(1.0, **{name: 0.0}))
    activations = healthy.activations_from(0.2, 0.05)
    healthy.settle(activations)
    paralysed.settle(activations)
    other = 1 - side
    np.testing.assert_allclose(angles_deg(paralysed)[other], angles_deg(healthy)[other], atol=1e-9)
    lost_deg = angles_deg(healthy)[side, ADDUCTION] - angles_deg(paralysed)[side, ADDUCTION]
    activations[MUSCLE_NAMES.index(name)] = 0.0
    healthy.settle(activations)
    np.testing.assert_allclose(angles_deg(paralysed), angles_deg(healthy), atol=1e-9)
    assert lost_deg == pytest.approx(8.0, abs=0.5)  # 0.2 medial is 8.0 deg in OpenEyeSim's map


def test_half_strength_is_half_the_activation():
    weak = eyes_with(strength=all_but(1.0, left_lateral_rectus=0.5))
    healthy = eyes_with()
    weak.settle(weak.activations_from(0.1, 0.08))
    activations = healthy.activations_from(0.1, 0.08)
    activations[1] = 0.04
    healthy.settle(activations)
    np.testing.assert_allclose(angles_deg(weak), angles_deg(healthy), atol=1e-9)


# Patients: 16 PD, 9.1 deg, for 6 mm of medial recession (Zak 1986).
@pytest.mark.parametrize("side", [LEFT, RIGHT])
@pytest.mark.parametrize(
    ("medial_mm", "lateral_mm", "adduction_deg", "with_half_the_stiffness_deg"),
    [
        (6, 0, -6.41, -10.29),
        (0, 6, 7.14, 12.64),
        (-6, 0, 3.40, 8.87),
        (0, -6, -3.35, -8.47),
        (6, -6, -9.51, -16.89),
        (-6, 6, 10.03, 19.01),
    ],
)
def test_surgery_turns_an_eye_by_so_much(
    side, medial_mm, lateral_mm, adduction_deg, with_half_the_stiffness_deg
):
    eye = ("left", "right")[side]
    moved = {f"{eye}_medial_rectus": medial_mm, f"{eye}_lateral_rectus": lateral_mm}
    doses = {"parameter_set": "anatomical", "recession_mm": all_but(0.0, **moved)}
    for stiffness, turned_deg in ((1.0, adduction_deg), (0.5, with_half_the_stiffness_deg)):
        eyes = eyes_with(**doses, tissue_stiffness=stiffness)
        expected_deg = np.where(np.arange(2) == side, turned_deg, 0.0)
        np.testing.assert_allclose(angles_deg(eyes)[:, ADDUCTION], expected_deg, atol=0.01)


@pytest.mark.parametrize("side", [LEFT, RIGHT])
def test_a_shifted_rest_position_turns_the_silent_eye_by_that_much(side):
    shift_deg = tuple(5.0 if i == side else 0.0 for i in (LEFT, RIGHT))
    healthy = eyes_with(parameter_set="anatomical")
    silent = np.zeros(12)
    strabismic = eyes_with(
        parameter_set="anatomical", rest_adduction_deg=shift_deg, rest_elevation_deg=shift_deg
    )
    for eyes in (healthy, strabismic):
        eyes.settle(silent)
    moved_deg = angles_deg(strabismic) - angles_deg(healthy)
    np.testing.assert_allclose(moved_deg[1 - side], 0.0, atol=1e-9)
    # Silent muscles are short of their optimal length, so the orbit alone holds the eye.
    np.testing.assert_allclose(moved_deg[side, :2], 5.0, atol=1e-6)


def test_a_wider_baseline_moves_the_eyes_apart_and_nothing_else():
    wide, normal = eyes_with(baseline_m=0.07), eyes_with()
    np.testing.assert_allclose(wide.eye_positions_m()[:, 1], [0.035, -0.035])
    np.testing.assert_allclose(angles_deg(wide), angles_deg(normal), atol=1e-9)


@pytest.mark.parametrize("parameter_set", SETS)
def test_moves_at_once_end_where_simulated_ones_do(parameter_set) -> None:
    draw = np.random.default_rng(3)
    simulated, at_once = (
        eyes_with(parameter_set=parameter_set, moves=moves) for moves in ("simulated", "at_once")
    )
    for _ in range(5):
        activations = draw.uniform(0.0, 0.2, 12)
        for eyes in (simulated, at_once):
            eyes.step(activations)
        assert angles_deg(at_once) == pytest.approx(angles_deg(simulated), abs=1e-9)
        state = at_once.state()
        assert (state.activations == activations).all()
        # Nothing was spent on the way.
        assert (state.mean_metabolic_rate_w == state.metabolic_rate_w).all()
