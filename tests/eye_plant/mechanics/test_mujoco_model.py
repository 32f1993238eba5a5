import mujoco
import numpy as np
import pytest

from eye_plant.mechanics.anatomical import ANATOMICAL
from eye_plant.mechanics.mujoco_model import AXES, MechanicsConfig, build_spec
from eye_plant.mechanics.muscles import receded_insertion_m
from lockstep import MUSCLE_NAMES

SETS = ("k17", "anatomical")


@pytest.fixture(params=SETS)
def model(request) -> mujoco.MjModel:
    return build_spec(MechanicsConfig(parameter_set=request.param)).compile()


def test_joints_and_muscles_stand_in_their_documented_order(model):
    assert tuple(model.joint(i).name for i in range(model.njnt)) == tuple(
        f"{side}_eye_{axis}" for side in ("left", "right") for axis in AXES
    )
    assert tuple(model.actuator(i).name for i in range(model.nu)) == MUSCLE_NAMES


def test_joint_angles_are_adduction_elevation_and_intorsion(model):
    data = mujoco.MjData(model)
    for i_side, nose in ((0, -1.0), (1, 1.0)):  # the nose lies at -y of the left eye
        side = ("left", "right")[i_side]
        for i_axis, column, component, sign in ((0, 0, 1, nose), (1, 0, 2, 1.0), (2, 2, 1, nose)):
            data.qpos[:] = 0.0
            data.qpos[3 * i_side + i_axis] = 0.1
            mujoco.mj_forward(model, data)
            rotation = data.body(f"{side}_eye").xmat.reshape(3, 3)
            assert rotation[component, column] * sign == pytest.approx(np.sin(0.1))


def test_globe_has_its_mass_inertia_and_place():
    model = build_spec(MechanicsConfig(baseline_m=0.06, eye_height_m=1.2)).compile()
    np.testing.assert_allclose(model.body("left_eye").pos, [0.0, 0.03, 1.2])
    np.testing.assert_allclose(model.body("right_eye").pos, [0.0, -0.03, 1.2])
    assert model.body("left_eye").mass == pytest.approx(7.5e-3)
    np.testing.assert_allclose(model.body("left_eye").inertia, 4.32e-7)
    np.testing.assert_allclose(model.dof_M0, 4.32e-7)


def test_orbital_tissue_pulls_back_by_its_polynomial():
    model = build_spec(MechanicsConfig(parameter_set="anatomical")).compile()
    data = mujoco.MjData(model)
    data.qpos[:] = (0.5, -0.4, 0.3, 0.5, -0.4, 0.3)
    mujoco.mj_forward(model, data)
    expected = -2.225e-3 * data.qpos - 3.453e-3 * data.qpos**3
    np.testing.assert_allclose(data.qfrc_spring, expected, rtol=1e-9)


def test_a_recession_moves_the_insertion_back_along_the_globe():
    muscle, orbit = ANATOMICAL.muscles["medial_rectus"], ANATOMICAL.orbit
    before = np.array(muscle.insertion_m)
    after = np.array(receded_insertion_m(muscle, orbit, 4.0))
    assert np.linalg.norm(after) == pytest.approx(np.linalg.norm(before))
    angle = np.arccos(before @ after / (before @ before))
    assert angle * orbit.globe_radius_m == pytest.approx(4e-3)
    pulley = np.array(muscle.pulley_m)
    assert np.linalg.norm(after - pulley) < np.linalg.norm(before - pulley)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"parameter_set": "k18"}, "parameter_set: expected k17 or anatomical, got 'k18'"),
        ({"baseline_m": -0.05}, "baseline_m: expected 0.025 to 1 m, got -0.05"),
        ({"strength": (1.0,) * 11}, "strength: expected 12 numbers, each 0 to 10, got"),
        (
            {"recession_mm": (0.0,) * 11 + (float("nan"),)},
            "recession_mm: expected 12 numbers, each -10 to 10 mm",
        ),
        (
            {"rest_adduction_deg": (0.0, 90.0)},
            "rest_adduction_deg: expected 2 numbers, each -30 to 30 deg",
        ),
    ],
)
def test_bad_settings_are_refused_by_name(changes, message):
    with pytest.raises(ValueError, match=message):
        MechanicsConfig(**changes)
