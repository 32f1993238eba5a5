"""Settings of the eye plant."""

from dataclasses import dataclass, field

from eye_plant.camera.config import CameraConfig
from eye_plant.mechanics.model import MechanicsConfig
from eye_plant.stimuli.stimulus_set import StimuliConfig
from lockstep.errors import InputError

# Beyond it, a period is shorter than the plant's time step.
MAX_RATE_HZ = 1000.0


@dataclass(frozen=True)
class FreeRunningConfig:
    """The plant without a protocol: rate_hz of observations (0: off), and what is shown."""

    rate_hz: float = 0.0
    stimulus: int = 0
    object_distance_m: float = 1.0

    def __post_init__(self) -> None:
        """Refuse rates that are none."""
        if not 0.0 <= self.rate_hz <= MAX_RATE_HZ:
            raise InputError(
                f"free_running.rate_hz: expected 0 to {MAX_RATE_HZ}, got {self.rate_hz}"
            )


@dataclass(frozen=True)
class EyePlantConfig:
    """Settings of the plant: each field's own fields are ROS parameters, mechanics.* and so on."""

    mechanics: MechanicsConfig = field(default_factory=MechanicsConfig)
    camera: CameraConfig = field(default_factory=CameraConfig)
    stimuli: StimuliConfig = field(default_factory=StimuliConfig)
    free_running: FreeRunningConfig = field(default_factory=FreeRunningConfig)
