"""Two MuJoCo eyes, moved by twelve muscles, that look at a textured plane.

Importing this package imports no ROS, and its modules only when a name of theirs is asked for.
"""

from typing import TYPE_CHECKING

from lockstep.lazy_names import lazy_names

if TYPE_CHECKING:
    from eye_plant.config import EyePlantConfig
    from eye_plant.episode import Episode
    from eye_plant.head.head import Head
    from eye_plant.inverse.gaze import GazeInverse
    from eye_plant.inverse.pair import Inverse
    from eye_plant.node.head_node import run_head
    from eye_plant.observation import Observation
    from eye_plant.plant import EyePlant
    from eye_plant.stimuli.stimulus_set import StimulusSet, load_stimuli
    from eye_plant.vergence import desired_vergence_deg, fixation_distance_m

__all__ = [
    "Episode",
    "EyePlant",
    "EyePlantConfig",
    "GazeInverse",
    "Head",
    "Inverse",
    "Observation",
    "StimulusSet",
    "desired_vergence_deg",
    "fixation_distance_m",
    "load_stimuli",
    "run_head",
]

_MODULES = {
    "eye_plant.config": "EyePlantConfig",
    "eye_plant.episode": "Episode",
    "eye_plant.head.head": "Head",
    "eye_plant.inverse.gaze": "GazeInverse",
    "eye_plant.inverse.pair": "Inverse",
    "eye_plant.node.head_node": "run_head",
    "eye_plant.observation": "Observation",
    "eye_plant.plant": "EyePlant",
    "eye_plant.stimuli.stimulus_set": "StimulusSet load_stimuli",
    "eye_plant.vergence": "desired_vergence_deg fixation_distance_m",
}
__getattr__ = lazy_names(__name__, _MODULES)
