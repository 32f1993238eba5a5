"""Two MuJoCo eyes, moved by twelve muscles, that look at a textured plane."""

import importlib
import os


def _import_mujoco_without_opengl() -> None:
    """Import MuJoCo, which would load the OpenGL that MUJOCO_GL names, with none named.

    OpenGL is loaded where it draws, by eye_plant.camera.opengl.offscreen, so that all else works
    where there is none.
    """
    wanted = os.environ.get("MUJOCO_GL")
    os.environ["MUJOCO_GL"] = "disable"
    importlib.import_module("mujoco")
    if wanted is None:
        del os.environ["MUJOCO_GL"]
    else:
        os.environ["MUJOCO_GL"] = wanted


_import_mujoco_without_opengl()
