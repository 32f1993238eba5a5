"""How episodes begin where each muscle has a command: within the ranges."""

import numpy as np
import pytest

from experiment_manager.experiment.config import ProtocolConfig
from experiment_manager.experiment.starts import (
    GazeStarts,
    conditions,
    draw_angles_deg,
    gaze_inverse,
)
from eye_plant.inverse.gaze import GAZE_ANGLES
from eye_plant.mechanics.model import MechanicsConfig
from lockstep.command_space import ALL_MUSCLES, HORIZONTAL_RECTI

MECHANICS = MechanicsConfig(parameter_set="anatomical")
LARGEST_DEG = {"horizontal": 3, "vertical": 1.5, "torsional": 4, "version": 5, "elevation": 5}


def _config(space: str = ALL_MUSCLES) -> ProtocolConfig:
    return ProtocolConfig(
        command_space=space, lowest_activations=(0.0,), highest_activations=(0.2,)
    )


def test_training_begins_anywhere_within_the_ranges() -> None:
    config = _config()
    starts, draw = GazeStarts(config, MECHANICS), np.random.default_rng(1)
    inverse = gaze_inverse(config, MECHANICS)
    gazes_deg = []
    for _ in range(40):
        distance_m, activations = starts.training(draw)
        assert 0.5 <= distance_m <= 6.0
        gazes_deg.append(inverse.gaze_deg(np.array(activations), distance_m))
    largest_deg = np.array([LARGEST_DEG[name] for name in GAZE_ANGLES])
    reached = np.abs(gazes_deg).max(axis=0) / largest_deg
    assert (reached <= 1.0 + 1e-6).all()
    assert (reached > 0.8).all()


def test_a_test_has_the_same_starts_for_all_seeds_and_pictures() -> None:
    config = _config()
    found = conditions(config, MECHANICS.baseline_m)
    assert len(found) == 7 * 6
    assert len({condition.start_error_deg for condition in found}) == 42
    starts = GazeStarts(config, MECHANICS)
    one, other = (starts.trial(found[5], np.random.default_rng(seed)) for seed in (1, 2))
    assert one == other
    inverse = gaze_inverse(config, MECHANICS)
    gaze_deg = inverse.gaze_deg(np.array(one), found[5].object_distance_m)
    assert gaze_deg[0] == pytest.approx(found[5].start_error_deg, abs=1e-5)


def test_horizontal_recti_begin_with_what_they_turn() -> None:
    drawn = draw_angles_deg(_config(HORIZONTAL_RECTI), np.random.default_rng(1))
    assert list(drawn) == ["horizontal", "version"]
