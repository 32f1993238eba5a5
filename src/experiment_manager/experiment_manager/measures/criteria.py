"""What the measures count as close enough and as silent: it depends on a run's eyes and cameras."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any, Self

from experiment_manager.config import ExperimentManagerConfig
from experiment_manager.plant_changes import Schedule, read_schedule
from experiment_manager.sections import DEFAULTS, EYES, TASK, config_of
from eye_plant import EyePlantConfig, Inverse, fixation_distance_m
from eye_plant.config import changed
from eye_plant.lens.config import LensesConfig
from eye_plant.mechanics.metabolics import silent_activation
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from eye_plant.vergence import degrees_per_px
from lockstep import InputError
from lockstep.wire.topics import TEST

# Relaxed eyes see an object right whose vergence differs by less than this from theirs.
_RELAXED_PX = 0.5
# Settings that older runs do not have; all were made with their defaults.
_NOT_IN_OLDER_RUNS = (
    *("noise.", "scales.", "lenses."),
    *("camera.left_cataract", "camera.right_cataract", "mechanics.tissue_stiffness"),
)


@dataclass(frozen=True)
class Criteria:
    """What counts with the eyes and cameras of one test.

    px_deg: the visual angle of one pixel at the picture's centre (K17 II). silent_activation: below
    it a muscle's cost no longer falls. Objects up to lateral_is_silent_up_to_m ask for more
    vergence than relaxed eyes have, so that the lateral recti should be silent; those from
    medial_is_silent_from_m on ask for less. In between either may hold the gaze at hardly any cost.
    lowest_activations: of each command that turns the eyes, at which a muscle with a tonic floor is
    silent. Of joints only px_deg is known.
    fixation_iterations: of a fixation, 0 of eyes that make no saccades; lenses: of eyes that focus.
    """

    px_deg: float
    silent_activation: float
    lateral_is_silent_up_to_m: float
    medial_is_silent_from_m: float
    lowest_activations: tuple[float, ...]
    fixation_iterations: int = 0
    lenses: LensesConfig = field(default_factory=LensesConfig)


def criteria_of(plant: EyePlantConfig, fixation_iterations: int = 0) -> Criteria:
    """Return what counts with a plant's cameras and eyes."""
    if plant.space.of_joints:
        px_deg = degrees_per_px(plant.camera.focal_length_px)
        return Criteria(px_deg, math.nan, math.nan, math.nan, plant.limits.lowest)
    criteria = _criteria(plant.camera.focal_length_px, plant.mechanics, plant.turning_limits.lowest)
    return replace(criteria, fixation_iterations=fixation_iterations, lenses=plant.lenses)


@lru_cache
def _criteria(
    focal_length_px: float, mechanics: MechanicsConfig, lowest: tuple[float, ...]
) -> Criteria:
    px_deg = degrees_per_px(focal_length_px)
    relaxed_deg = float(sum(Inverse(mechanics).adduction_deg(0.0, 0.0)))
    margin_deg = _RELAXED_PX * px_deg
    return Criteria(
        px_deg=px_deg,
        silent_activation=silent_activation(mechanics.parameters.energetics),
        lateral_is_silent_up_to_m=_distance_m(relaxed_deg + margin_deg, mechanics.baseline_m),
        medial_is_silent_from_m=_distance_m(relaxed_deg - margin_deg, mechanics.baseline_m),
        lowest_activations=lowest,
    )


@dataclass(frozen=True)
class EvaluationSettings:
    """How a run is tested: the plant that it was started with, and how a schedule changes that.

    iterations_per_trial: of a whole trial; fixation_iterations: of a fixation, 0 without saccades;
    gives_targets: whether training gives gaze targets, as tests do.
    """

    plant: EyePlantConfig
    schedule: Schedule
    iterations_per_trial: int
    fixation_iterations: int = 0
    gives_targets: bool = True

    @classmethod
    def of(cls, configuration: Mapping[str, Mapping[str, Any]]) -> Self:
        """Return those of a run's configuration by section.

        Raises InputError where a part of the task or of the eyes is missing: its default may be
        that of another experiment.
        """
        for section in (TASK, EYES):
            of_section = configuration.get(section, {})
            missing = [
                f"{section}.{name}"
                for name in DEFAULTS[section]
                if name not in of_section and not name.startswith(_NOT_IN_OLDER_RUNS)
            ]
            if missing:
                more = f" and {len(missing) - 1} more" if len(missing) > 1 else ""
                raise InputError(f"expected a run's configuration, it lacks {missing[0]}{more}")
        manager = config_of(ExperimentManagerConfig, configuration)
        return cls(
            config_of(EyePlantConfig, configuration),
            read_schedule(manager.schedule),
            manager.iterations_per_trial,
            manager.fixation_iterations,
            manager.gives_targets,
        )

    def criteria(self, training_iterations: int) -> Criteria:
        """Return what counts in the test after so many training iterations."""
        return criteria_of(self.tested_plant(training_iterations), self.fixation_iterations)

    def tested_plant(self, training_iterations: int) -> EyePlantConfig:
        """Return the plant of the test after so many training iterations."""
        stage = self.schedule.stage(TEST, training_iterations)
        return changed(self.plant, self.schedule.settings(stage))


def _distance_m(vergence_deg: float, baseline_m: float) -> float:
    """Return the distance that the eyes look at; infinite where they do not converge."""
    return fixation_distance_m(vergence_deg, baseline_m) if vergence_deg > 0.0 else math.inf
