"""The exported MJCF in plain MuJoCo, and what its README claims of it."""

import subprocess
import sys
from itertools import product
from pathlib import Path

import mujoco
import numpy as np
import pytest

from eye_plant.export.__main__ import export, main
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from eye_plant.mechanics.oculomotor import Oculomotor
from lockstep import MUSCLE_NAMES, InputError, build
from lockstep.command_space import MUSCLES
from tests.patience import PATIENCE_S

SETS = ("k17", "anatomical")


@pytest.fixture(scope="module")
def exported(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the directory with both files."""
    directory = tmp_path_factory.mktemp("export") / "eyes"
    export(directory)
    return directory


@pytest.mark.parametrize("parameter_set", SETS)
def test_the_keyframe_is_at_rest(exported: Path, parameter_set: str) -> None:
    model = mujoco.MjModel.from_xml_path(str(exported / f"eyes_{parameter_set}.xml"))
    assert tuple(model.actuator(i).name for i in range(model.nu)) == MUSCLE_NAMES
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    start = data.qpos.copy()
    mujoco.mj_step(model, data, 200)
    np.testing.assert_allclose(data.qpos, start, atol=1e-5)


def test_palsies_and_surgery_are_in_the_file(tmp_path: Path) -> None:
    strength, recession_mm = [1.0] * 12, [0.0] * 12
    strength[MUSCLE_NAMES.index("right_lateral_rectus")] = 0.0
    recession_mm[MUSCLE_NAMES.index("left_medial_rectus")] = 4.0
    lesions = {"strength": strength, "recession_mm": recession_mm}
    line = [f"eyes.mechanics.{name}={value}" for name, value in lesions.items()]
    assert main(["--out", str(tmp_path / "eyes"), "--set", line[0], "--set", line[1]]) == 0
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "eyes" / "eyes_anatomical.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    tonic = {"parameter_set": "anatomical"}
    eyes = Oculomotor(build(MechanicsConfig, tonic | lesions))
    np.testing.assert_allclose(data.qpos, eyes.data.qpos, atol=1e-6)
    healthy = Oculomotor(build(MechanicsConfig, tonic)).data.qpos
    # The left eye turns out, the right eye in; adductions come first.
    assert np.degrees(data.qpos - healthy)[0] < -2.0
    assert np.degrees(data.qpos - healthy)[3] > 2.0


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ("strength=[1]", "--set: expected eyes.mechanics.NAME=VALUE, got 'strength=[1]'"),
        ("eyes.mechanics.strength=[1]", "strength: expected 12 numbers"),
        ("eyes.mechanics.strenght=[1]", "unknown parameter strenght: did you mean strength"),
    ],
)
def test_what_is_no_lesion_is_refused(tmp_path: Path, capsys, setting, message) -> None:
    assert main(["--out", str(tmp_path / "eyes"), "--set", setting]) == 2
    assert capsys.readouterr().err.startswith(f"error: {message}")
    assert not (tmp_path / "eyes").exists()


def test_an_eyes_camera_looks_where_the_eye_does(exported: Path) -> None:
    model = mujoco.MjModel.from_xml_path(str(exported / "eyes_k17.xml"))
    data = mujoco.MjData(model)
    data.joint("left_eye_adduction").qpos = np.radians(10.0)
    mujoco.mj_forward(model, data)
    # The nose is to the right of the left eye, and y is to the left.
    forward = [np.cos(np.radians(10.0)), -np.sin(np.radians(10.0)), 0.0]
    _, up, backward = data.camera("left_eye").xmat.reshape(3, 3).T
    np.testing.assert_allclose(-backward, forward, atol=1e-6)
    np.testing.assert_allclose(up, [0, 0, 1], atol=1e-6)


def _readme_rows(exported: Path, n_cells: int) -> dict[str, list[str]]:
    """Return the other cells of the rows of the README's table with so many, by parameter set."""
    lines = (exported / "README.md").read_text().splitlines()
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines]
    return {row[0]: row[1:] for row in rows if len(row) == n_cells and row[0] in SETS}


def _difference_deg(parameter_set: str, model: mujoco.MjModel, duration_s: float) -> float:
    """Return the largest difference of plain MuJoCo's angles from the plant's equilibrium."""
    eyes, data = Oculomotor(MechanicsConfig(parameter_set=parameter_set)), mujoco.MjData(model)
    differences_rad = []
    for pair in product(np.linspace(0.0, 0.2, 6), np.linspace(0.0, 0.1, 6)):
        mujoco.mj_resetDataKeyframe(model, data, 0)
        data.ctrl[:] = eyes.activations_from(*pair)
        mujoco.mj_step(model, data, round(duration_s / model.opt.timestep))
        eyes.settle(data.ctrl)
        differences_rad.append(data.qpos - eyes.data.qpos)
    return float(np.degrees(np.abs(differences_rad).max()))


@pytest.mark.parametrize("parameter_set", SETS)
def test_the_readme_states_the_differences_in_plain_mujoco(exported, parameter_set) -> None:
    model = mujoco.MjModel.from_xml_path(str(exported / f"eyes_{parameter_set}.xml"))
    period, after_period, after_long = _readme_rows(exported, 4)[parameter_set]
    period_s = MechanicsConfig(parameter_set=parameter_set).period_s
    assert period == f"{period_s:g} s"
    found_deg = _difference_deg(parameter_set, model, period_s)
    assert after_period == f"{found_deg:.2g} deg"
    assert after_long == "below 1e-6 deg"
    assert _difference_deg(parameter_set, model, 10.0) < 1e-6


@pytest.mark.parametrize("parameter_set", SETS)
def test_the_readme_states_the_masses(exported, parameter_set) -> None:
    muscles = MechanicsConfig(parameter_set=parameter_set).parameters.muscles
    expected = [f"{1e3 * muscles[name].mass_kg:.2f}" for name in MUSCLES]
    assert _readme_rows(exported, 7)[parameter_set] == expected


def test_the_readmes_code_runs_without_this_project(exported: Path) -> None:
    code = (exported / "README.md").read_text().split("```python\n")[1].split("```")[0]
    done = subprocess.run(
        [sys.executable, "-I", "-c", code],
        cwd=exported,
        capture_output=True,
        text=True,
        check=True,
        timeout=PATIENCE_S,
    )
    (angle_deg,) = [float(word) for word in done.stdout.strip("[]\n ").split()]
    assert angle_deg == pytest.approx(float(code.split("# ")[1]), abs=5e-4)
    eyes = Oculomotor(MechanicsConfig())
    eyes.settle(np.array([0.1] + 11 * [0.0]))
    angle_rad = eyes.state().eye_angles_rad[0, 0]
    assert angle_deg == pytest.approx(np.degrees(angle_rad), abs=5e-4)


def test_a_directory_that_holds_something_is_refused(exported, capsys) -> None:
    with pytest.raises(InputError, match="expected a new or empty directory"):
        export(exported)
    assert main(["--out", str(exported)]) == 2
    assert capsys.readouterr().err.startswith("error: expected a new or empty directory")
