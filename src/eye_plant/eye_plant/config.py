"""Settings of the eye plant."""

from dataclasses import dataclass, field

from eye_plant.camera_config import CameraConfig
from eye_plant.model import MechanicsConfig
from eye_plant.stimuli import StimuliConfig


@dataclass(frozen=True)
class EyePlantConfig:
    """Settings of the plant: mechanics.*, camera.* and stimuli.* as ROS parameters."""

    mechanics: MechanicsConfig = field(default_factory=MechanicsConfig)
    camera: CameraConfig = field(default_factory=CameraConfig)
    stimuli: StimuliConfig = field(default_factory=StimuliConfig)
