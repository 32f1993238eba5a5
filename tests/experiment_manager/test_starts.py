"""How episodes begin where each muscle has a command, and what saccades go to: within ranges."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from experiment_manager import make_protocol
from experiment_manager.config import ExperimentManagerConfig, ProtocolConfig
from experiment_manager.starts import (
    GazeStarts,
    conditions,
    corner,
    draw_angles_deg,
    drawn_targets_deg,
    gaze_inverse,
)
from eye_plant.camera.config import CameraConfig
from eye_plant.inverse.gaze import GAZE_ANGLES
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from eye_plant.mechanics.oculomotor import Oculomotor
from lockstep import ALL_MUSCLES, HORIZONTAL_RECTI, InputError, build, flatten
from lockstep.wire.topics import TEST

MECHANICS = MechanicsConfig(parameter_set="anatomical")
LARGEST_DEG = {"horizontal": 3, "vertical": 1.5, "torsional": 4, "version": 5, "elevation": 5}


def _config(space: str = ALL_MUSCLES, **settings: Any) -> ExperimentManagerConfig:
    return ExperimentManagerConfig(
        command_space=space, lowest_activations=(0.0,), highest_activations=(0.2,), **settings
    )


def _training_gazes_deg(config: ExperimentManagerConfig) -> np.ndarray:
    starts, draw = GazeStarts(config, MECHANICS), np.random.default_rng(1)
    inverse = gaze_inverse(config, MECHANICS)
    gazes_deg = []
    for _ in range(40):
        distance_m, activations = starts.training(draw)
        assert 0.5 <= distance_m <= 6.0
        gazes_deg.append(inverse.gaze_deg(np.array(activations), distance_m))
    return np.array(gazes_deg)


def test_training_begins_anywhere_within_the_ranges() -> None:
    largest_deg = np.array([LARGEST_DEG[name] for name in GAZE_ANGLES])
    reached = np.abs(_training_gazes_deg(_config())).max(axis=0) / largest_deg
    assert (reached <= 1.0 + 1e-6).all()
    assert (reached > 0.8).all()


@pytest.mark.parametrize("of_tests", [False, True])
@pytest.mark.parametrize("share", [0.0, 0.5])
def test_episodes_begin_anywhere_and_some_in_the_corner(share, of_tests) -> None:
    config, draw = _config(aside_share=share), np.random.default_rng(1)
    sides = [*corner(config, of_tests=of_tests), 0.0, 0.0]
    drawn = [draw_angles_deg(config, draw, of_tests=of_tests) for _ in range(2000)]
    shares = np.array([[*angles_deg.values()] for angles_deg in drawn]) / [*LARGEST_DEG.values()]
    assert list(drawn[0]) == list(LARGEST_DEG)
    # Half of a uniform variable's mean, 0, and half of one's in [0.7, 1] on the corner's side.
    np.testing.assert_allclose(shares.mean(axis=0), share * 0.85 * np.array(sides), atol=0.05)
    # Nothing is left out on the other side.
    for quarter in np.linspace(-1.0, 0.5, 4):
        within = ((shares >= quarter) & (shares < quarter + 0.5)).mean(axis=0)
        assert (within > 0.2 * (1.0 - share)).all()


def test_the_corner_is_another_one_in_each_run_and_the_opposite_in_tests() -> None:
    corners = np.array(
        [[corner(_config(seed=seed), of_tests=t) for t in (False, True)] for seed in range(20)]
    )
    np.testing.assert_array_equal(corners[:, 0], -corners[:, 1])
    assert set(np.abs(corners).ravel()) == {1.0}
    assert (np.abs(corners[:, 0].mean(axis=0)) < 0.7).all()


def test_training_about_the_tonic_level_needs_no_inverse(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr("eye_plant.inverse.gaze.GazeInverse.activations")
    config = _config(tonic_start_spread=0.005)
    tonic = Oculomotor(MECHANICS).tonic_activations
    at_tonic_deg = gaze_inverse(config, MECHANICS).gaze_deg(tonic, 1.0)
    gazes_deg = _training_gazes_deg(config)
    # Up and aside they lie about the tonic gaze, whatever the plane's distance.
    np.testing.assert_allclose(gazes_deg[:, 3:].mean(axis=0), at_tonic_deg[3:], atol=1.0)
    assert gazes_deg[:, 3:].std(axis=0).max() < 3.0
    assert gazes_deg[:, 3:].std(axis=0).min() > 0.5


def test_superior_obliques_alike_rotate_the_eyes_and_leave_vertical_errors() -> None:
    own, both = (
        _config(tonic_start_spread=0.002, tonic_common_spread=(0.0, 0.0, 0.0, 0.0, spread, 0.0))
        for spread in (0.0, 0.02)
    )
    more = _training_gazes_deg(both).std(axis=0) / _training_gazes_deg(own).std(axis=0)
    assert 0.8 < more[1] < 1.25
    assert more[2] > 3.0


def test_an_episode_begins_with_what_the_last_one_left() -> None:
    config = _config(fixation_iterations=5, tonic_return=0.25)
    starts, tonic = GazeStarts(config, MECHANICS), Oculomotor(MECHANICS).tonic_activations
    _, first = starts.training(np.random.default_rng(1))
    assert first == tuple(tonic.tolist())
    left = 2.0 * tonic
    left[3] = 0.9  # beyond its limit
    distance_m, then = starts.training(np.random.default_rng(2), tuple(left))
    expected = 1.75 * tonic
    expected[3] = 0.2
    np.testing.assert_allclose(then, expected, rtol=1e-12)
    assert distance_m == starts.training(np.random.default_rng(2))[0]
    for condition in conditions(config, MECHANICS.baseline_m)[:2]:
        assert starts.trial(condition, np.random.default_rng(3)) == first
    with pytest.raises(InputError, match="expected 0 without saccades"):
        _config(tonic_return=0.25)


def test_a_test_has_the_same_starts_for_all_pictures_and_others_for_each_seed() -> None:
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
    elsewhere = conditions(_config(seed=2), MECHANICS.baseline_m)
    assert not {c.start_error_deg for c in found} & {c.start_error_deg for c in elsewhere}


def _begins_after_change(schedule: str, *, follows: bool) -> tuple[float, ...]:
    config = _config(
        n_training_iterations=20,
        test_iterations=(),
        mechanics=MECHANICS,
        schedule=schedule,
        starts_follow_changes=follows,
    )
    sequence = make_protocol(config)
    return sequence.episode(sequence.place_after(10)).activations


def test_training_after_a_change_begins_as_before_unless_it_follows() -> None:
    change = "[{at: 10, set: {eyes.camera.right_rotation_deg: -5.0}}]"
    before = _begins_after_change("", follows=False)
    assert _begins_after_change(change, follows=False) == before
    assert _begins_after_change(change, follows=True) != before


def test_eyes_behind_a_prism_begin_with_the_errors_that_they_see() -> None:
    config = _config(
        schedule="[{at: 10, set: {eyes.camera.right_rotation_deg: -5.0}}]",
        n_training_iterations=20,
        test_iterations=(0,),
        mechanics=MECHANICS,
    )
    sequence, inverse = make_protocol(config), gaze_inverse(config, MECHANICS)
    first, last = (sequence.episode(sequence.place_after(n)) for n in (0, 20))
    assert (first.phase, last.phase) == (TEST, TEST)
    eyes_deg = [
        inverse.gaze_deg(np.array(episode.activations), episode.object_distance_m)
        for episode in (first, last)
    ]
    assert eyes_deg[1][0] - eyes_deg[0][0] == pytest.approx(-5.0, abs=0.05)
    assert eyes_deg[1][1:] == pytest.approx(eyes_deg[0][1:], abs=0.2)

    # The same where the cameras are turned from the start.
    turned = replace(config, schedule="", camera=CameraConfig(right_rotation_deg=-5.0))
    assert make_protocol(turned).episode(0).activations == last.activations


def test_horizontal_recti_begin_with_what_they_turn() -> None:
    drawn = draw_angles_deg(_config(HORIZONTAL_RECTI), np.random.default_rng(1))
    assert list(drawn) == ["horizontal", "version"]


SACCADES = ProtocolConfig(
    command_space=ALL_MUSCLES,
    lowest_activations=(0.0,),
    highest_activations=(0.2,),
    fixation_iterations=5,
    target_distance_deg=(2.0, 10.0),
    largest_target_deg=(8.0, 6.0),
)


def drawn_deg(gaze_deg: tuple[float, float], seed: int) -> np.ndarray:
    draw = np.random.default_rng(seed)
    return np.array(drawn_targets_deg(SACCADES, 20, gaze_deg, draw)).reshape(-1, 2)


def test_targets_are_within_range_and_at_a_drawn_distance_from_one_another() -> None:
    for seed in range(50):
        targets_deg = drawn_deg((1.0, -2.0), seed)
        assert targets_deg.shape == (4, 2)
        assert (np.abs(targets_deg) <= (8.0, 6.0)).all()
        steps = np.diff(np.vstack([(1.0, -2.0), targets_deg]), axis=0)
        away_deg = np.hypot(*steps.T)
        assert ((away_deg >= 2.0) & (away_deg <= 10.0)).all()


def test_all_directions_are_drawn() -> None:
    steps = np.array([drawn_deg((0.0, 0.0), seed)[0] for seed in range(200)])
    quadrants = {(x > 0, y > 0) for x, y in steps}
    assert len(quadrants) == 4


def test_eyes_that_look_too_far_aside_come_back() -> None:
    np.testing.assert_array_equal(np.abs(drawn_deg((40.0, 0.0), 1)[0, 0]), 8.0)


@pytest.mark.parametrize("name", ["iterations_per_episode", "iterations_per_trial"])
def test_episodes_and_trials_are_whole_fixations(name: str) -> None:
    settings = flatten(SACCADES) | {"iterations_per_episode": 20, name: 8}
    with pytest.raises(InputError, match=rf"{name}: expected a multiple of 5 \(fixation_iter"):
        build(ProtocolConfig, settings)


def test_the_pair_makes_no_saccades() -> None:
    with pytest.raises(InputError, match="fixation_iterations: expected 0 with command_space pair"):
        ProtocolConfig(fixation_iterations=5)
