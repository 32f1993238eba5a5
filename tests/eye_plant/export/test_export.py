"""The exported MJCF in plain MuJoCo, and what its README claims of it."""

import subprocess
import sys
from pathlib import Path

import mujoco
import numpy as np
import pytest

from eye_plant.export.__main__ import export, main
from eye_plant.mechanics.model import MechanicsConfig
from eye_plant.mechanics.oculomotor import Oculomotor
from lockstep.command_space import MUSCLE_NAMES
from lockstep.errors import InputError

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


def test_the_readme_states_measured_differences(exported: Path) -> None:
    rows = [
        line.split("|")
        for line in (exported / "README.md").read_text().splitlines()
        if line.count(" deg ") == 2
    ]
    after_s = {row[1].strip(): [float(cell.split()[0]) for cell in row[3:5]] for row in rows}
    assert set(after_s) == set(SETS)
    assert after_s["k17"][0] < 0.02  # the plant's promise: settled within a control period
    # Six digits of each number are written; the equilibrium forgives that.
    assert all(long_deg < 1e-3 for _, long_deg in after_s.values())


def test_the_readmes_code_runs_without_this_project(exported: Path) -> None:
    code = (exported / "README.md").read_text().split("```python\n")[1].split("```")[0]
    done = subprocess.run(
        [sys.executable, "-I", "-c", code], cwd=exported, capture_output=True, text=True, check=True
    )
    (angle_rad,) = [float(word) for word in done.stdout.strip("[]\n ").split()]
    eyes = Oculomotor(MechanicsConfig())
    eyes.settle(np.array([0.1] + 11 * [0.0]))
    assert angle_rad == pytest.approx(eyes.state().eye_angles_rad[0, 0], abs=1e-5)


def test_a_directory_that_holds_something_is_refused(exported, capsys) -> None:
    with pytest.raises(InputError, match="expected a new or empty directory"):
        export(exported)
    assert main([str(exported)]) == 2
    assert capsys.readouterr().err.startswith("error: expected a new or empty directory")
