"""Whether eyes with these muscles can do what a protocol asks, found out before anything starts."""

import functools
import itertools
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from experiment_manager.config import ExperimentManagerConfig, ProtocolConfig
from experiment_manager.plant_changes import read_schedule
from experiment_manager.sections import config_of
from experiment_manager.starts import (
    Condition,
    conditions,
    gaze_inverse,
    largest_angles_deg,
)
from eye_plant import EyePlantConfig, Inverse, desired_vergence_deg
from eye_plant.inverse.least_cost import check_tabled
from eye_plant.inverse.pair import Limits
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from eye_plant.turns import TurnsDeg
from lockstep import PAIR, InputError

# What is asked for may lie on the limit itself, and is solved for to a millionth of this.
_TOLERANCE_DEG = 0.01
# Of the line of pairs that give a vergence; version is greatest at one of its ends.
_ENDS = (0.0, 1.0)
# Episodes begin anywhere on the lines of a range of vergences: a grid this fine stands for them.
_N_VERGENCES, _N_FRACTIONS = 33, 9


def check_reach(configuration: Mapping[str, Mapping[str, Any]]) -> None:
    """Raise InputError unless the eyes of a run reach what its episodes begin with and aim at.

    configuration: by section. With the activations within the protocol's limits, each
    vergence that is asked for must come about, and both lines of sight must then meet the plane;
    so it must with the eyes of each stage of the run's schedule. Any pair of activations with which
    an episode may begin must have one rest, so that no run stops half-way for want of it. What a
    robot's head reaches, it alone knows.
    """
    manager = config_of(ExperimentManagerConfig, configuration)
    if manager.space.of_joints:
        return
    started_with = config_of(EyePlantConfig, configuration)
    tested = conditions(manager, started_with.mechanics.baseline_m)
    schedule = read_schedule(manager.schedule)
    ats = [0, *(change.at for change in schedule.changes)]
    for at, plant in zip(ats, schedule.plants(started_with), strict=True):
        try:
            _check_eyes(manager, plant, tested)
        except InputError as error:
            raise InputError(f"schedule, at {at}: {error}" if at else str(error)) from error


def _check_eyes(
    protocol: ProtocolConfig, plant: EyePlantConfig, tested: Sequence[Condition]
) -> None:
    mechanics, plane_m = plant.mechanics, plant.camera.plane_size_m
    if protocol.turning_space != PAIR:
        _check_gazes(protocol, mechanics, plant.camera.turns_deg, plane_m)
        return
    inverse, limits = Inverse(mechanics), protocol.pair_limits
    distances_m = _distances_m(protocol)
    aimed_at_deg = [desired_vergence_deg(d, mechanics.baseline_m) for d in distances_m]
    started_deg = _started_deg(protocol, tested, mechanics.baseline_m)
    _check_vergence(inverse, limits, [*started_deg, *aimed_at_deg])
    _check_pairs(mechanics, limits, (min(started_deg), max(started_deg)))
    for distance_m, vergence_deg in zip(distances_m, aimed_at_deg, strict=True):
        _check_version(inverse, limits, vergence_deg, distance_m, plane_m)


@functools.lru_cache(maxsize=64)
def _check_gazes(
    protocol: ProtocolConfig, mechanics: MechanicsConfig, turns_deg: TurnsDeg, plane_m: float
) -> None:
    """Raise InputError unless the muscles reach the outermost first gazes, and correct ones.

    Eyes that look aside must still look at the plane, and the least cost there must be known.
    """
    distances_m = _distances_m(protocol)
    for distance_m in distances_m:
        check_tabled(desired_vergence_deg(distance_m, mechanics.baseline_m))
    most_deg = math.degrees(math.atan(plane_m / 2.0 / distances_m[-1]))
    if max(protocol.start_version_deg) > most_deg:
        raise InputError(
            f"start_version_deg: expected {most_deg:.1f} deg at most, where the plane ends at "
            f"{distances_m[-1]:g} m, got {list(protocol.start_version_deg)}"
        )
    inverse = gaze_inverse(protocol, mechanics, turns_deg)
    at_tonic_level = np.zeros(len(protocol.space.turning.names))
    largest_deg = largest_angles_deg(protocol)
    corners = itertools.product(*((-most, most) for most in largest_deg.values()))
    for corner in (*corners, np.zeros(len(largest_deg))):
        angles_deg = dict(zip(largest_deg, corner, strict=True))
        for distance_m in (distances_m[0], distances_m[-1]):
            inverse.activations(angles_deg, distance_m, at_tonic_level)


def _distances_m(protocol: ProtocolConfig) -> list[float]:
    return sorted({*protocol.object_distance_m, *protocol.test_distances_m})


def _started_deg(
    protocol: ProtocolConfig, tested: Sequence[Condition], baseline_m: float
) -> list[float]:
    """Return vergences with which episodes begin: those of tests, the ends of those of training."""
    trained_deg = [desired_vergence_deg(d, baseline_m) for d in protocol.fixation_distance_m]
    return trained_deg + [
        desired_vergence_deg(condition.object_distance_m, baseline_m) - condition.start_error_deg
        for condition in tested
    ]


def _check_vergence(inverse: Inverse, limits: Limits, asked_deg: Sequence[float]) -> None:
    least_deg, most_deg = inverse.vergence_range_deg(limits)
    if least_deg > min(asked_deg) + _TOLERANCE_DEG or most_deg < max(asked_deg) - _TOLERANCE_DEG:
        raise InputError(
            f"mechanics: expected muscles that reach vergences from {min(asked_deg):.2f} to "
            f"{max(asked_deg):.2f} deg, as the protocol's distances and start errors require; "
            f"with medial activations in {list(limits[0])} and lateral ones in {list(limits[1])} "
            f"these reach {least_deg:.2f} to {most_deg:.2f} deg"
        )


@functools.lru_cache(maxsize=64)  # runs of a sweep often have the same eyes
def _check_pairs(
    mechanics: MechanicsConfig, limits: Limits, vergences_deg: tuple[float, float]
) -> None:
    """Raise InputError unless eyes have one rest at all pairs that give a vergence in the range."""
    inverse = Inverse(mechanics)
    least_deg, most_deg = np.clip(vergences_deg, *inverse.vergence_range_deg(limits))
    for vergence_deg in np.linspace(least_deg, most_deg, _N_VERGENCES):
        for fraction in np.linspace(0.0, 1.0, _N_FRACTIONS):
            _pair(inverse, float(vergence_deg), float(fraction), limits)


def _pair(
    inverse: Inverse, vergence_deg: float, fraction: float, limits: Limits
) -> tuple[float, float]:
    try:
        return inverse.activation_pair(vergence_deg, fraction, limits)
    except InputError as error:
        raise InputError(f"mechanics: {error}") from error


def _check_version(
    inverse: Inverse, limits: Limits, vergence_deg: float, distance_m: float, plane_m: float
) -> None:
    """Look at both ends of the line of pairs that give the vergence."""
    for fraction in _ENDS:
        pair = _pair(inverse, vergence_deg, fraction, limits)
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
