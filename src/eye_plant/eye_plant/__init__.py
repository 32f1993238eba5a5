"""Two MuJoCo eyes, moved by twelve muscles, that look at a textured plane.

Importing this package imports no ROS.
"""

from eye_plant.config import EyePlantConfig
from eye_plant.episode import Episode
from eye_plant.inverse.gaze import GazeInverse
from eye_plant.inverse.pair import Inverse
from eye_plant.observation import Observation
from eye_plant.plant import EyePlant
from eye_plant.stimuli.stimulus_set import StimulusSet, load_stimuli
from eye_plant.vergence import desired_vergence_deg, fixation_distance_m

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
