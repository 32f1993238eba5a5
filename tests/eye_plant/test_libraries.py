"""Libraries with which the eyes would turn elsewhere, or not at all, are one error by name."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from eye_plant.export.__main__ import export
from tests.patience import PATIENCE_S

OLDER = "3.17.0"  # the last one before 4.0, of which MJX and dm_control are
_INSTALL_S = 25
LOAD = """
import mujoco, sys
for name in sys.argv[1:]:
    try:
        mujoco.MjModel.from_xml_path(name)
    except ValueError as error:
        print(mujoco.__version__, error)
"""


def _said(code: str, *arguments: str, fails: bool = True, **variables: str) -> str:
    done = subprocess.run(
        [sys.executable, "-c", code, *arguments],
        env=os.environ | variables,
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE_S,
    )
    assert (done.returncode != 0) == fails, done.stderr
    return (done.stderr if fails else done.stdout).strip()


@pytest.mark.parametrize(
    ("module", "expected"),
    [
        ("__version__ = '3.10.0'", "expected MuJoCo 4.0 or newer, got 3.10.0 in "),
        (
            "raise OSError('libmujoco.so.3.17.0: cannot open')",  # two versions in one folder
            "expected MuJoCo 4.0 or newer, got none that works (OSError: libmujoco.so.3.17.0",
        ),
        ("", "expected MuJoCo 4.0 or newer, got none that works (AttributeError"),
    ],
)
def test_another_mujoco_is_one_error(tmp_path: Path, module: str, expected: str) -> None:
    (tmp_path / "mujoco").mkdir()
    (tmp_path / "mujoco/__init__.py").write_text(module)
    for imported in ("eye_plant.mechanics.oculomotor", "experiment_manager.loop"):
        said = _said(f"import {imported}", PYTHONPATH=str(tmp_path)).splitlines()[-1]
        assert said.startswith(f"ImportError: {expected}")
        assert said.endswith("then python3 -m pip install 'mujoco>=4'")


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("NUMBA_DISABLE_JIT", "1"),
        ("NUMBA_NUM_THREADS", "0"),
        ("OPENCV_FOR_THREADS_NUM", "abc"),
    ],
)
def test_a_variable_with_which_a_library_fails_is_named(monkeypatch, name, value) -> None:
    monkeypatch.setenv(name, value)
    said = _said("import eye_plant.plant").splitlines()[-1]
    assert said.startswith("ImportError: expected numba")
    assert f"{name}={value}" in said


def test_compiling_is_announced_once() -> None:
    code = (
        "import eye_plant.libraries, numba\n"
        "for _ in range(2):\n"
        "    def loop(n): return n + 1\n"
        "    loop.__module__ = 'eye_plant.loops'\n"
        "    numba.njit('int64(int64)')(loop)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=PATIENCE_S
    )
    assert done.stderr.count("compiling the simulation, once") == 1


def test_an_older_mujoco_refuses_the_exported_files_and_is_refused(tmp_path: Path) -> None:
    pip = [sys.executable, "-m", "pip", "install", "-q", "--no-deps", "--retries=0", "--timeout=5"]
    older = str(tmp_path / "older")
    try:
        subprocess.run(
            [*pip, "--target", older, f"mujoco=={OLDER}"],
            check=True,
            capture_output=True,
            text=True,
            timeout=_INSTALL_S,
        )
    except subprocess.CalledProcessError as error:
        pytest.skip(f"pip cannot install mujoco {OLDER} here: {error.stderr.strip()[-200:]}")
    except subprocess.TimeoutExpired:
        pytest.skip(f"pip does not install mujoco {OLDER} within {_INSTALL_S} s")
    export(tmp_path / "eyes")
    files = sorted(map(str, (tmp_path / "eyes").glob("*.xml")))
    refusals = _said(LOAD, *files, fails=False, PYTHONPATH=older)
    assert refusals.count(f"{OLDER} XML Error: Schema violation") == len(files) == 2
    said = _said("import eye_plant.plant", PYTHONPATH=older)
    assert f"ImportError: expected MuJoCo 4.0 or newer, got {OLDER} in {older}" in said
