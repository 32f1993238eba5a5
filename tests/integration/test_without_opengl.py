"""Runs with the renderer that needs no OpenGL, on a machine that has none."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.graph_harness import small_run
from tests.patience import PATIENCE_S
from tests.stress.supervised_run import SupervisedRun, stamp_faults
from tests.supervisor import environment

# Every Python of the run refuses OpenGL: its Python packages, and the libraries by any name.
REFUSAL = """
import ctypes, importlib.abc, sys

class NoOpenGL(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in ("OpenGL", "glfw"):
            raise AssertionError(f"{name} is imported")
        return None

class NoLibrary(ctypes.CDLL):
    def __init__(self, name, *arguments, **named):
        if any(part in str(name) for part in ("libGL", "libEGL", "libOSMesa", "libglfw")):
            raise OSError(f"{name} is not installed")
        super().__init__(name, *arguments, **named)

sys.meta_path.insert(0, NoOpenGL())
ctypes.CDLL = NoLibrary
"""


@pytest.fixture
def refusing(tmp_path: Path) -> tuple[str, ...]:
    """Return the variables of an environment without OpenGL, whatever was found at set-up."""
    folder = tmp_path / "refusal"
    folder.mkdir()
    (folder / "sitecustomize.py").write_text(REFUSAL)
    return (f"PYTHONPATH={folder}", "MUJOCO_GL=egl")


def line(pictures: Path, *more: str) -> list[str]:
    settings = ("task.n_bases=32", *more)
    return small_run(pictures, 60, *settings)


@pytest.mark.parametrize(("in_process", "is_named"), [(False, False), (True, True)])
def test_the_plane_is_drawn(refusing, pictures, tmp_path, in_process, is_named) -> None:
    directory = tmp_path / "run"
    named = ["eyes.camera.renderer=plane"] if is_named else []
    with SupervisedRun(
        line(pictures, *named), directory, in_process=in_process, prefix=("env", *refusing)
    ) as run:
        assert run.wait() == 0, run.output()
        assert run.output().count("eyes.camera.renderer is plane") == (not is_named)
    assert "renderer: plane" in (directory / "config.yaml").read_text()
    assert stamp_faults(directory) == []
    if not in_process:
        return
    tested = subprocess.run(
        [
            *(sys.executable, "-m", "active_binocular_vision.commands.evaluate", str(directory)),
            *("--stimuli", str(pictures), "--out", str(tmp_path / "tested.json")),
        ],
        env=environment() | dict(variable.split("=", 1) for variable in refusing),
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )
    assert tested.returncode == 0, tested.stderr
