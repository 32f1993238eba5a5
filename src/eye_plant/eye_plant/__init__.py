"""Two MuJoCo eyes, moved by twelve muscles, that look at a textured plane.

Importing this package imports no ROS.
"""

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

from eye_plant.config import EyePlantConfig  # noqa: E402
from eye_plant.episode import Episode  # noqa: E402
from eye_plant.inverse.gaze import GazeInverse  # noqa: E402
from eye_plant.inverse.pair import Inverse  # noqa: E402
from eye_plant.observation import Observation  # noqa: E402
from eye_plant.plant import EyePlant  # noqa: E402
from eye_plant.stimuli.stimulus_set import StimulusSet, load_stimuli  # noqa: E402
from eye_plant.vergence import desired_vergence_deg, fixation_distance_m  # noqa: E402

__all__ = [
    "Episode",
    "EyePlant",
    "EyePlantConfig",
    "GazeInverse",
    "Inverse",
    "Observation",
    "StimulusSet",
    "desired_vergence_deg",
    "fixation_distance_m",
    "load_stimuli",
]
