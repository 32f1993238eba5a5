"""A plant that is changed is as one that was made so, and muscles hold what they were told."""

import math
from dataclasses import replace

import numpy as np
import pytest

from eye_plant import Episode, EyePlant, EyePlantConfig, StimulusSet
from eye_plant.config import changed
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from eye_plant.stimuli.stereograms import random_dot_stereograms
from lockstep import ALL_MUSCLES, MUSCLE_NAMES, InputError
from lockstep.wire.topics import TRAINING
from tests.pair import HORIZONTAL_RECTI, pair_activations

ALTERED = {
    "mechanics.rest_adduction_deg": [0.0, 2.0],
    "mechanics.baseline_m": 0.062,
    "camera.left_blur_px": 3.0,
    "camera.right_magnification": 1.1,
}


@pytest.fixture(scope="module")
def stimuli():
    noise = np.random.default_rng(0).integers(0, 256, (300, 300), dtype=np.uint8)
    return StimulusSet((noise,), (), random_dot_stereograms(seed=2, n=1, size_px=300))


@pytest.fixture(scope="module")
def plain():
    return EyePlantConfig()


@pytest.fixture
def made(stimuli):
    """Return what makes a plant of a configuration that shows the stimuli."""
    plants = []

    def make(config):
        plants.append(EyePlant(config, stimuli))
        return plants[-1]

    yield make
    for plant in plants:
        plant.close()


def seen(plant, stimulus=0):
    episode = Episode.alone(stimulus, 1.0, pair_activations(0.04, 0.01), n_iterations=2)
    first = plant.begin(episode)
    second = plant.execute(plant.targets(["medial_rectus", "lateral_rectus"], np.array([0.05, 0])))
    return [
        (o.pictures.tobytes(), o.ground_truth_values(), o.state.eye_angles_rad.tobytes())
        for o in (first, second)
    ]


def test_a_changed_plant_is_as_one_made_so_and_back(plain, made):
    plant, anew = made(plain), made(changed(plain, ALTERED))
    before, expected = seen(plant), seen(anew)
    assert before != expected
    plant.reconfigure(ALTERED)
    assert seen(plant) == expected
    plant.reconfigure({})
    assert seen(plant) == before


def test_a_refused_change_leaves_the_plant_as_it_was(plain, made):
    plant = made(plain)
    before = seen(plant)
    for settings, message in (
        ({"camera.left_blur_px": -1.0}, "left_blur_px: expected 0 px or more"),
        ({"camera.width_px": 64}, "camera.width_px: expected the same for a whole run"),
        # By which turns are measured in pictures.
        ({"camera.focal_length_px": 200.0}, "camera.focal_length_px: expected the same"),
        ({"mechanics.control_period_s": 0.1}, "control_period_s: expected the same"),
        ({"camera.blur": 1.0}, "unknown parameter camera.blur"),
    ):
        with pytest.raises(InputError, match=message):
            plant.reconfigure(settings)
    assert seen(plant) == before


def test_a_refused_episode_changes_nothing(plain, made):
    plant = made(replace(plain, lowest_activations=(0.0, 0.9), highest_activations=(0.2, 1.0)))
    with pytest.raises(InputError, match="no medial activation in"):
        plant.begin(Episode.alone(0, 0.5, pair_activations(0.04, 0.9), n_iterations=2))
    assert not plant.is_waiting


def test_the_eyes_should_meet_where_a_stereograms_dots_fuse(plain, made, stimuli):
    (shown,) = stimuli.stereograms
    parallax_m = shown.parallax * 3.0
    assert parallax_m != 0.0
    desired_deg = seen(made(plain), stimulus=1)[0][1][10]
    assert desired_deg == pytest.approx(np.degrees(2 * np.arctan((0.056 + parallax_m) / 2.0)))


def test_a_prism_adds_to_the_errors_of_eyes_with_commands_of_their_own(plain, made) -> None:
    anatomical = MechanicsConfig(parameter_set="anatomical")
    own = replace(
        plain,
        command_space=ALL_MUSCLES,
        lowest_activations=(0.0,),
        highest_activations=(0.2,),
        mechanics=anatomical,
    )
    episode = Episode.alone(0, 1.0, pair_activations(0.04, 0.01), n_iterations=1)
    for config, added_deg in ((own, 10.0), (plain, 0.0)):
        plant = made(config)
        before = plant.begin(episode).truth
        # Base out: the eyes converge too little, and have to converge more.
        plant.reconfigure({"camera.right_rotation_deg": -10.0})
        with_prism = plant.begin(episode).truth
        errors = with_prism.gaze_error.horizontal_deg, with_prism.desired_vergence_deg
        expected = before.gaze_error.horizontal_deg, before.desired_vergence_deg
        assert np.subtract(errors, expected) == pytest.approx([added_deg] * 2, abs=0.01)


def test_each_command_adds_to_those_before_it(plain, made) -> None:
    plant = made(plain)
    episode = Episode.alone(0, 2.0, pair_activations(0.05, 0.02), n_iterations=5)
    recti = [MUSCLE_NAMES.index(name) for name in HORIZONTAL_RECTI]

    def told(*names: str, values: list[float]) -> list[float]:
        observation = plant.execute(plant.targets(names, np.array(values)))
        found: list[float] = observation.state.activations[recti].tolist()
        return found

    plant.begin(episode)
    # left medial, left lateral, right medial, right lateral
    expected = [0.1, 0.02, 0.05, 0.02]
    assert told("left_medial_rectus", values=[0.1]) == pytest.approx(expected)
    expected = [0.1, 0.02, 0.05, 0.03]
    assert told("right_lateral_rectus", values=[0.03]) == pytest.approx(expected)
    plant.begin(replace(episode, first_observation=10))
    expected = [0.05, 0.02, 0.05, 0.04]
    assert told("right_lateral_rectus", values=[0.04]) == pytest.approx(expected)


def test_a_command_of_muscles_with_their_own_names_all_of_them(plain, made) -> None:
    plant = made(
        replace(
            plain, command_space=ALL_MUSCLES, lowest_activations=(0.0,), highest_activations=(0.2,)
        )
    )
    with pytest.raises(InputError, match=r"expected left_medial_rectus, .*, as command_space al"):
        plant.targets(MUSCLE_NAMES[:6], np.zeros(6))
    values = np.linspace(0.0, 0.11, 12)
    in_reverse = plant.targets(MUSCLE_NAMES[::-1], values[::-1])
    assert in_reverse.tolist() == values.tolist()


def test_the_least_cost_of_a_trial_is_that_at_the_target_of_then(plain, made):
    config = replace(
        plain,
        command_space=ALL_MUSCLES,
        mechanics=MechanicsConfig(parameter_set="anatomical"),
        lowest_activations=(0.0,),
        highest_activations=(0.2,),
    )
    plant, tonic = made(config), [0.05] * 12
    trial = Episode.alone(0, 2.0, tonic, n_iterations=2, targets_deg=(8.0, 8.0, -8.0, 0.0))

    def least_w(episode):
        first = plant.begin(episode)
        others = [plant.execute(np.array(tonic)) for _ in range(episode.n_iterations)]
        return [o.truth.optimal_metabolic_rate_w for o in (first, *others)]

    # By the inverse with all its first weights. The second target holds to the end.
    assert least_w(trial) == pytest.approx([0.0529, 0.0335, 0.0335], abs=1e-4)
    assert least_w(replace(trial, targets_deg=())) == pytest.approx([0.0107] * 3, abs=1e-4)
    # Training may have other targets than the episode gives.
    assert all(map(math.isnan, least_w(replace(trial, phase=TRAINING))))
