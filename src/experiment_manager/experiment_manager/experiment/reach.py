"""Whether eyes with these muscles can do what a protocol asks, found out before anything starts."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from experiment_manager.experiment.config import ExperimentManagerConfig, bounds
from experiment_manager.experiment.plant_changes import read_schedule, stages_of
from experiment_manager.experiment.protocol import conditions
from eye_plant.config import EyePlantConfig
from eye_plant.geometry import desired_vergence_deg
from eye_plant.mechanics.inverse import Inverse, Limits
from lockstep.configuration import build
from lockstep.errors import InputError

# What is asked for may lie on the limit itself, and is solved for to a millionth of this.
_TOLERANCE_DEG = 0.01
# Of the line of pairs that give a vergence: both ends, and between them whether eyes come to it.
_FRACTIONS = (0.0, 0.25, 0.5, 0.75, 1.0)


def check_reach(parameters: Mapping[str, Mapping[str, Any]]) -> None:
    """Raise InputError unless the eyes of a run reach what its episodes begin with and aim at.

    parameters: of all nodes, by node. With the activations within the protocol's limits, each
    vergence that is asked for must come about, and both lines of sight must then meet the plane;
    so it must with the eyes of each stage of the run's schedule.
    """
    manager = build(ExperimentManagerConfig, parameters["experiment_manager"])
    started_with = build(EyePlantConfig, parameters["eye_plant"])
    for at, plant in stages_of(read_schedule(manager.schedule), started_with):
        try:
            _check_eyes(replace(manager, mechanics=plant.mechanics, schedule=""), plant)
        except InputError as error:
            raise InputError(f"schedule, at {at}: {error}" if at else str(error)) from error


def _check_eyes(config: ExperimentManagerConfig, plant: EyePlantConfig) -> None:
    plane_m = plant.camera.plane_size_m
    inverse = Inverse(config.mechanics)
    limits = (
        bounds(config.protocol.medial_rectus_limits),
        bounds(config.protocol.lateral_rectus_limits),
    )
    _check_vergence(config, inverse, limits)
    for distance_m in _distances_m(config):
        _check_version(config, inverse, limits, distance_m, plane_m)


def _distances_m(config: ExperimentManagerConfig) -> list[float]:
    protocol = config.protocol
    return sorted({*protocol.object_distance_m, *protocol.test_distances_m})


def _check_vergence(config: ExperimentManagerConfig, inverse: Inverse, limits: Limits) -> None:
    baseline_m = config.mechanics.baseline_m
    asked_deg = [
        desired_vergence_deg(distance_m, baseline_m)
        for distance_m in (*_distances_m(config), *config.protocol.fixation_distance_m)
    ]
    asked_deg += [
        desired_vergence_deg(condition.object_distance_m, baseline_m) - condition.start_error_deg
        for condition in conditions(config.protocol, baseline_m)
    ]
    least_deg, most_deg = inverse.vergence_range_deg(limits)
    if least_deg > min(asked_deg) + _TOLERANCE_DEG or most_deg < max(asked_deg) - _TOLERANCE_DEG:
        raise InputError(
            f"mechanics: expected muscles that reach vergences from {min(asked_deg):.2f} to "
            f"{max(asked_deg):.2f} deg, which the protocol's distances and start errors ask for; "
            f"with medial activations in {list(limits[0])} and lateral ones in {list(limits[1])} "
            f"these reach {least_deg:.2f} to {most_deg:.2f} deg"
        )


def _check_version(
    config: ExperimentManagerConfig,
    inverse: Inverse,
    limits: Limits,
    distance_m: float,
    plane_m: float,
) -> None:
    """Look at the line of pairs that give the vergence; version is greatest at one of its ends."""
    vergence_deg = desired_vergence_deg(distance_m, config.mechanics.baseline_m)
    for fraction in _FRACTIONS:
        try:
            pair = inverse.activation_pair(vergence_deg, fraction, limits)
        except InputError as error:
            raise InputError(f"mechanics: {error}") from error
        left_deg, right_deg = inverse.adduction_deg(*pair)
        version_deg = (left_deg - right_deg) / 2.0
        most_deg = math.degrees(math.atan(plane_m / 2.0 / distance_m))
        if abs(version_deg) > most_deg:
            raise InputError(
                f"mechanics: expected eyes that look at the plane when they converge on "
                f"{distance_m:g} m, within {most_deg:.1f} deg of its centre; with medial "
                f"{pair[0]:.3f} and lateral {pair[1]:.3f} they look {abs(version_deg):.1f} deg to "
                f"the {'right' if version_deg > 0.0 else 'left'}"
            )
