"""Settings of the eye plant."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from eye_plant.camera.config import CameraConfig
from eye_plant.inverse.least_cost import CostOfVergence, cost_of_vergence
from eye_plant.lens.config import LensesConfig
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from eye_plant.senses import NoiseConfig
from eye_plant.stimuli.stimulus_set import StimuliConfig
from eye_plant.turns import TurnsDeg
from lockstep import InputError, build, check_settings, flatten, setting
from lockstep.task import TaskConfig

# No machine draws more pictures in time.
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
class EyesConfig:
    """The eyes: what moves them, their cameras with what stands before them, and their noise."""

    mechanics: MechanicsConfig = field(default_factory=MechanicsConfig)
    camera: CameraConfig = field(default_factory=CameraConfig)
    noise: NoiseConfig = field(default_factory=NoiseConfig)
    lenses: LensesConfig = field(default_factory=LensesConfig)


@dataclass(frozen=True)
class EyePlantConfig(TaskConfig, EyesConfig):
    """Settings of the plant: the task, the eyes, and what only the plant needs."""

    stimuli: StimuliConfig = field(default_factory=StimuliConfig)
    free_running: FreeRunningConfig = field(default_factory=FreeRunningConfig)

    @property
    def least_costs_of(self) -> tuple[MechanicsConfig, str, tuple[float, ...], TurnsDeg]:
        """What the least costs depend on, as cost_of_vergence takes it."""
        lowest = self.turning_limits.lowest
        return self.mechanics, self.turning_space, lowest, self.camera.turns_deg

    @property
    def worn_camera(self) -> CameraConfig:
        """The cameras with what spectacles magnify, where eyes have lenses."""
        if not self.space.has_lenses or not any(self.lenses.spectacles_d):
            return self.camera
        left, right = self.lenses.magnifications
        return replace(
            self.camera,
            left_magnification=self.camera.left_magnification * left,
            right_magnification=self.camera.right_magnification * right,
        )

    @property
    def cost_of_vergence(self) -> CostOfVergence:
        """The least costs of these eyes."""
        return cost_of_vergence(*self.least_costs_of)


# What a run is built on: sizes and stamps of messages, the pictures, who draws them.
_FIXED = (
    "mechanics.parameter_set",
    "mechanics.eye_height_m",
    "mechanics.control_period_s",
    "mechanics.moves",
    "camera.renderer",
    "camera.width_px",
    "camera.height_px",
    "camera.focal_length_px",
    "camera.roi_width_px",
    "camera.roi_height_px",
)

# Where turns are measured, which is never told of a change.
_OF_CODER = ("noise.turn_sd_deg", "noise.missing_turns")


def changeable_parameters() -> tuple[str, ...]:
    """Return the names of the parameters that may change between two episodes of a run."""
    return tuple(name for name in flatten(EyesConfig()) if name not in (*_FIXED, *_OF_CODER))


def changed(config: EyePlantConfig, settings: Mapping[str, Any]) -> EyePlantConfig:
    """Return a configuration with other values, by dotted name.

    Of parameters that may change, or of noise of turns, for a test. Raises InputError for others,
    and as `build` does.
    """
    allowed = {*changeable_parameters(), *_OF_CODER}
    if fixed := sorted(set(settings) & set(flatten(config)) - allowed):
        raise InputError(f"{fixed[0]}: expected the same for a whole run, got a change")
    return build(EyePlantConfig, flatten(config) | dict(settings))
