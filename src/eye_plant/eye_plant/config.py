"""Settings of the eye plant."""

from dataclasses import dataclass, field

from eye_plant.camera.config import CameraConfig
from eye_plant.mechanics.model import MechanicsConfig
from eye_plant.stimuli.stimulus_set import StimuliConfig
from lockstep.settings import check_settings, setting

# Beyond it, a period is shorter than the plant's time step.
MAX_RATE_HZ = 1000


@dataclass(frozen=True)
class FreeRunningConfig:
    """The plant without a protocol: observations at a fixed rate, and what is shown."""

    rate_hz: float = setting(
        0.0, "rate of observations; 0: lockstep with the learners", "Hz", least=0, most=MAX_RATE_HZ
    )
    stimulus: int = setting(
        0, "number of the stimulus shown, training stimuli first, then test stimuli", least=0
    )
    object_distance_m: float = setting(1.0, "distance of the plane shown", "m", above=0)

    def __post_init__(self) -> None:
        """Refuse values out of range."""
        check_settings(self)


@dataclass(frozen=True)
class EyePlantConfig:
    """Settings of the plant: each field's own fields are ROS parameters, mechanics.* and so on."""

    mechanics: MechanicsConfig = field(default_factory=MechanicsConfig)
    camera: CameraConfig = field(default_factory=CameraConfig)
    stimuli: StimuliConfig = field(default_factory=StimuliConfig)
    free_running: FreeRunningConfig = field(default_factory=FreeRunningConfig)
