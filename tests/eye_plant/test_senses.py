"""Noise of pictures and of felt activations, and what is missing of them."""

import numpy as np
import pytest

from eye_plant import Episode, EyePlant, EyePlantConfig, StimulusSet
from eye_plant.camera.config import CameraConfig
from eye_plant.senses import NoiseConfig, Senses
from lockstep import InputError, build, flatten
from lockstep.randomness import Moment
from tests.pair import pair_activations

CAMERA = CameraConfig()
GREY = np.full((2, 240, 320), 128, np.uint8)
ACTIVATIONS = np.array([0.0, 1.0, *[0.1] * 10])


def at(number):
    return Moment(training_iteration=number)


def bytes_of(observation):
    return observation.pictures.tobytes()


def seen(observation):
    """Return whether each eye's picture shows anything."""
    return [bool(picture.any()) for picture in observation.pictures]


def senses(seed=1, camera=CAMERA, **noise):
    return Senses(NoiseConfig(**noise), camera, seed)


def test_without_noise_everything_is_as_it_is() -> None:
    plain = senses()
    assert plain.pictures(GREY, at(3)) is GREY
    assert plain.felt(ACTIVATIONS, at(3)) is ACTIVATIONS


def test_noise_of_pictures_is_gaussian_and_independent_in_eyes_and_time() -> None:
    noisy = senses(picture_sd=5.0)
    first, second = (noisy.pictures(GREY, at(number)) - 128.0 for number in (3, 4))
    # Rounding adds a twelfth of a grey level squared; the SD of 76,800 pixels is known to 0.3 %.
    assert first.std(axis=(1, 2)) == pytest.approx([np.sqrt(25.0 + 1.0 / 12.0)] * 2, rel=0.02)
    assert first.mean() == pytest.approx(0.0, abs=0.1)
    assert np.mean(np.abs(first) < 2.5) == pytest.approx(0.383, abs=0.01)  # half an SD
    for a, b in ((first[0], first[1]), (first[0], second[0])):
        assert np.corrcoef(a.ravel(), b.ravel())[0, 1] == pytest.approx(0.0, abs=0.02)


def test_noise_is_a_function_of_seed_and_moment() -> None:
    noise = {"picture_sd": 3.0, "activation_sd": 0.01}
    one, other = senses(**noise), senses(**noise)
    one.pictures(GREY, at(1)), one.felt(ACTIVATIONS, at(1))
    assert one.pictures(GREY, at(7)).tobytes() == other.pictures(GREY, at(7)).tobytes()
    assert one.felt(ACTIVATIONS, at(7)).tobytes() == other.felt(ACTIVATIONS, at(7)).tobytes()
    third = senses(seed=2, **noise)
    assert third.pictures(GREY, at(7)).tobytes() != other.pictures(GREY, at(7)).tobytes()
    assert third.felt(ACTIVATIONS, at(7)).tobytes() != other.felt(ACTIVATIONS, at(7)).tobytes()


def test_a_region_of_interest_has_the_noise_of_the_full_picture() -> None:
    camera = CameraConfig(roi_width_px=100, roi_height_px=60)
    region = senses(camera=camera, picture_sd=5.0).pictures(GREY[:, :60, :100], at(5))
    full = senses(picture_sd=5.0).pictures(GREY, at(5))
    np.testing.assert_array_equal(region, full[:, 90:150, 110:210])


def test_grey_levels_end_at_black_and_white() -> None:
    noisy = senses(picture_sd=5.0)
    assert noisy.pictures(np.zeros_like(GREY), at(1)).max() < 50
    assert noisy.pictures(np.full_like(GREY, 255), at(1)).min() > 205


def test_a_missing_picture_is_the_last_one_of_its_eye() -> None:
    gaps = senses(missing_pictures=0.5)
    # Of observation i, the left one is 2 i, the right one 2 i + 1.
    seen = [
        gaps.pictures(np.arange(2 * i, 2 * i + 2, dtype=np.uint8)[:, None, None] + GREY * 0, at(i))
        for i in range(100)
    ]
    shown = np.array([pictures[:, 0, 0] for pictures in seen], int) // 2
    assert (shown[0] == 0).all(), "nothing is missing in the first observation of an episode"
    is_missing = shown[1:] != np.arange(1, 100)[:, None]
    np.testing.assert_array_equal(shown[1:][is_missing], shown[:-1][is_missing])
    assert is_missing.mean(axis=0) == pytest.approx([0.5, 0.5], abs=0.2)
    assert (is_missing[:, 0] != is_missing[:, 1]).any(), "each eye has gaps of its own"


def test_an_episode_does_not_begin_with_what_the_last_one_ended_with() -> None:
    gaps = senses(missing_pictures=1.0, missing_activations=1.0)
    gaps.pictures(GREY, at(1)), gaps.felt(ACTIVATIONS, at(1))
    assert (gaps.pictures(GREY + 9, at(2)) == GREY).all()
    assert (gaps.felt(ACTIVATIONS / 2, at(2)) == ACTIVATIONS).all()
    gaps.begin()
    assert (gaps.pictures(GREY + 9, at(3)) == GREY + 9).all()
    assert (gaps.felt(ACTIVATIONS / 2, at(3)) == ACTIVATIONS / 2).all()


def test_activations_are_felt_with_noise_in_0_to_1() -> None:
    noisy = senses(activation_sd=0.02)
    felt = np.array([noisy.felt(ACTIVATIONS, at(number)) for number in range(500)])
    assert felt.min() == 0.0
    assert felt.max() == 1.0
    errors = felt[:, 2:] - 0.1
    assert errors.std(axis=0) == pytest.approx([0.02] * 10, rel=0.15)
    assert errors.mean() == pytest.approx(0.0, abs=0.001)


@pytest.mark.parametrize(
    ("noise", "reason"),
    [
        ({"picture_sd": -1.0}, "picture_sd: expected 0 to 255, got -1"),
        ({"missing_pictures": 1.5}, "missing_pictures: expected 0 to 1, got 1.5"),
        ({"activation_sd": 2.0}, "activation_sd: expected 0 to 1, got 2"),
        ({"turn_sd_deg": -0.1}, "turn_sd_deg: expected 0 deg or more"),
    ],
)
def test_what_no_noise_can_be_is_refused(noise, reason) -> None:
    with pytest.raises(InputError, match=reason):
        NoiseConfig(**noise)


def test_the_truth_has_no_noise_and_a_plant_may_get_and_lose_it() -> None:
    texture = np.random.default_rng(0).integers(0, 256, (64, 64), np.uint8)
    settings = {"noise.picture_sd": 4.0, "noise.activation_sd": 0.01}
    plain = EyePlantConfig()
    stimuli = StimulusSet((texture,), (texture,))
    noise = build(EyePlantConfig, flatten(plain) | settings)
    plants = [EyePlant(config, stimuli) for config in (plain, noise)]
    episode = Episode.alone(0, 1.0, pair_activations(0.04, 0.01), n_iterations=1)
    without, noisy = (plant.begin(episode) for plant in plants)
    seen = bytes_of(noisy)
    assert noisy.ground_truth_values() == without.ground_truth_values()
    assert noisy.state.activations.tobytes() == without.state.activations.tobytes()
    assert noisy.felt.tobytes() != without.felt.tobytes()
    assert seen != bytes_of(without)
    plants[0].reconfigure(settings)
    changed = plants[0].begin(episode)
    assert bytes_of(changed) == seen
    assert changed.felt.tobytes() == noisy.felt.tobytes()
    plants[0].reseed(9)
    assert bytes_of(plants[0].begin(episode)) != seen
    for plant in plants:
        plant.close()
