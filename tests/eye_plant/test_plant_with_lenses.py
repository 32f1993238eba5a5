"""The plant of eyes with lenses: commands, what is felt, and pictures at every scale."""

import copy
import pickle
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from eye_plant import Episode, EyePlant, EyePlantConfig, StimulusSet
from eye_plant.camera.config import CameraConfig
from eye_plant.lens.config import LensesConfig
from eye_plant.messages import ObservationMessages
from eye_plant.observation import Observation
from eye_plant.senses import NoiseConfig
from lockstep import COMMAND_SPACES, PAIR, InputError
from lockstep.scales import ScalesConfig
from lockstep.wire.cdr import image_array
from lockstep.wire.topics import EYE_STATE_NAMES, eye_state_names
from lockstep.wire.vectors import read_vector
from tests.pair import pair_activations

THREE = ScalesConfig(
    names=("coarse", "fine", "foveal"),
    window_px=(128, 40, 40),
    size_px=(32, 40, 40),
    zoom=(1.0, 1.0, 4.0),
    focus_d=(0.0, 0.0, 0.0),
    n_for_lenses=1,
)
CONFIG = EyePlantConfig(
    command_space="pair_and_lenses",
    lowest_activations=(0.0,),
    highest_activations=(0.2, 0.1, 1.0, 1.0),
    scales=THREE,
    camera=CameraConfig(plane_size_m=1.5, roi_width_px=128, roi_height_px=128),
)
WITHOUT_LENSES = replace(
    CONFIG,
    command_space="pair",
    highest_activations=(0.2, 0.1),
    scales=replace(THREE, n_for_lenses=0),
)
NAMES = CONFIG.space.names
START = pair_activations(0.03, 0.0)
PICTURE = np.kron(np.random.default_rng(1).integers(0, 256, (256, 256)), np.ones((4, 4)))
STIMULI = StimulusSet((PICTURE.astype(np.uint8),), (PICTURE.astype(np.uint8),))
# The activation for 1 D, at which an object at 1 m is in focus.
ONE_D = 1.0 / 12.5


@pytest.fixture(scope="module")
def plant() -> Iterator[EyePlant]:
    plant = EyePlant(CONFIG, STIMULI)
    yield plant
    plant.close()


def looked(plant: EyePlant, left_d: float, right_d: float, **settings: Any) -> Observation:
    """Return what eyes see of an object at 1 m that accommodate so far."""
    plant.reconfigure(settings)
    plant.begin(Episode.alone(0, 1.0, START, 3))
    command = np.array([0.03, 0.0, left_d * ONE_D, right_d * ONE_D])
    return plant.execute(plant.targets(NAMES, command))


def sharpness(pictures: np.ndarray) -> list[float]:
    """Return the SD of differences between neighbouring pixels, of the left and the right eye."""
    return [float(np.diff(picture.astype(float)).std()) for picture in pictures]


def test_an_episode_begins_at_rest_unless_it_says_where(plant: EyePlant) -> None:
    plant.reconfigure({})
    seen = plant.begin(Episode.alone(0, 1.0, START, 3))
    assert seen.lenses is not None
    np.testing.assert_allclose(seen.lenses.accommodation_d, 1.5)
    given = (*START, 0.2, 0.5, 0.4, 1.0)
    seen = plant.begin(Episode.alone(0, 1.0, given, 3))
    assert seen.lenses is not None
    np.testing.assert_allclose(seen.lenses.accommodation_d, [2.5, 5.0])
    np.testing.assert_allclose(seen.activations, given)


def test_each_lens_has_its_command_and_is_felt(plant: EyePlant) -> None:
    seen = looked(plant, 1.0, 3.0)
    assert seen.lenses is not None
    np.testing.assert_allclose(seen.lenses.focus_d, [1.0, 3.0])
    np.testing.assert_allclose(
        CONFIG.space.from_all(seen.felt), [0.03, 0.0, ONE_D, 3.0 * ONE_D], atol=1e-12
    )
    assert len(seen.felt) == 16
    rates_w = seen.rates_w(CONFIG.space)
    assert len(rates_w) == 6
    assert (rates_w[4:] == 0.0).all()
    assert rates_w.sum() == pytest.approx(seen.truth.metabolic_rate_w)


def test_a_command_may_name_pupils_and_both_lenses(plant: EyePlant) -> None:
    looked(plant, 1.0, 1.0)
    targets = plant.targets(["ciliary", "left_sphincter"], np.array([0.24, 1.0]))
    lenses = plant.execute(targets).lenses
    assert lenses is not None
    np.testing.assert_allclose(lenses.accommodation_d, 3.0)
    np.testing.assert_allclose(lenses.pupil_m, [0.002, 0.004])


def test_the_eye_out_of_focus_sees_blur_at_every_scale_and_most_at_the_finest(
    plant: EyePlant,
) -> None:
    sharp, blurred = looked(plant, 1.0, 1.0), looked(plant, 1.0, 2.0)
    assert sharp.pictures is not None
    assert blurred.pictures is not None
    np.testing.assert_array_equal(blurred.pictures[0], sharp.pictures[0])
    np.testing.assert_array_equal(blurred.apart[0][0], sharp.apart[0][0])
    wide = sharpness(blurred.pictures)[1] / sharpness(sharp.pictures)[1]
    foveal = sharpness(blurred.apart[0])[1] / sharpness(sharp.apart[0])[1]
    assert foveal < 0.8 * wide < 0.8
    too_far = looked(plant, 1.0, 0.0)
    np.testing.assert_array_equal(too_far.apart[0], blurred.apart[0])  # blur has no sign


def test_eyes_in_focus_see_what_eyes_without_lenses_see(plant: EyePlant) -> None:
    plain = EyePlant(replace(WITHOUT_LENSES, scales=ScalesConfig()), STIMULI)
    plain.begin(Episode.alone(0, 1.0, START, 3))
    expected = plain.execute(plain.targets(NAMES[:2], np.array([0.03, 0.0])))
    np.testing.assert_array_equal(looked(plant, 1.0, 1.0).pictures, expected.pictures)
    assert expected.lenses is None
    assert expected.apart == ()
    plain.close()


def test_a_region_of_interest_has_the_bits_of_the_whole_picture(plant: EyePlant) -> None:
    blurred = looked(plant, 3.0, 4.0)
    whole = EyePlant(replace(CONFIG, camera=CameraConfig(plane_size_m=1.5)), STIMULI)
    all_of_it = looked(whole, 3.0, 4.0)
    assert all_of_it.pictures is not None
    np.testing.assert_array_equal(all_of_it.pictures[:, 56:184, 96:224], blurred.pictures)
    np.testing.assert_array_equal(all_of_it.apart[0], blurred.apart[0])
    whole.close()


def test_the_foveal_picture_shows_the_middle_of_the_others_four_times_as_large(
    plant: EyePlant,
) -> None:
    seen = looked(plant, 1.0, 1.0)
    assert seen.pictures is not None
    for wide, foveal in zip(seen.pictures, seen.apart[0], strict=True):
        reduced = foveal.reshape(10, 4, 10, 4).mean(axis=(1, 3))
        middle = wide[59:69, 59:69].astype(float)
        assert np.corrcoef(reduced.ravel(), middle.ravel())[0, 1] > 0.9


def test_chromatic_aberration_gives_blur_a_sign() -> None:
    """The colour that is focused more is sharper when the eye focuses too far."""
    two_colours = ScalesConfig(
        names=("coarse", "long", "short"),
        window_px=(128, 40, 40),
        size_px=(32, 40, 40),
        zoom=(1.0, 4.0, 4.0),
        focus_d=(0.0, -0.5, 0.5),
        n_for_lenses=2,
    )
    plant = EyePlant(replace(CONFIG, scales=two_colours), STIMULI)
    for accommodation_d, sign in ((0.5, 1.0), (1.5, -1.0)):
        long, short = looked(plant, accommodation_d, accommodation_d).apart
        assert sign * (sharpness(short)[0] - sharpness(long)[0]) > 0.0
    plant.close()


def test_glasses_focus_a_hyperope_and_magnify(plant: EyePlant) -> None:
    hyperope = {"lenses.refraction_d": [2.0, 2.0]}
    blurred = looked(plant, 1.0, 1.0, **hyperope)
    assert blurred.lenses is not None
    np.testing.assert_allclose(blurred.lenses.error_d(1.0), -2.0)
    lens = {"lenses.contact_lenses_d": [2.0, 2.0]}
    np.testing.assert_array_equal(
        looked(plant, 1.0, 1.0, **hyperope, **lens).pictures, looked(plant, 1.0, 1.0).pictures
    )
    glasses = replace(CONFIG, lenses=LensesConfig(spectacles_d=(5.0, 0.0)))
    assert glasses.worn_camera.magnifications == pytest.approx((1.0 / 0.94, 1.0))
    plain = replace(WITHOUT_LENSES, lenses=glasses.lenses)
    assert plain.worn_camera == plain.camera


def test_a_cataract_is_a_veil_before_one_eye(plant: EyePlant) -> None:
    clear = looked(plant, 1.0, 1.0)
    veiled = looked(plant, 1.0, 1.0, **{"camera.left_cataract": 0.75})
    assert clear.pictures is not None
    assert veiled.pictures is not None
    expected = np.rint(0.25 * clear.pictures[0] + 0.75 * 128.0)
    np.testing.assert_array_equal(veiled.pictures[0], expected)
    np.testing.assert_array_equal(veiled.pictures[1], clear.pictures[1])


def test_eyes_that_run_free_focus_slowly(plant: EyePlant) -> None:
    plant.reconfigure({})
    plant.begin(Episode.alone(0, 1.0, START, 3))
    targets = plant.targets(["ciliary"], np.array([3.0 * ONE_D]))
    lenses = plant.advance(targets, 0.25).lenses
    assert lenses is not None
    np.testing.assert_allclose(lenses.accommodation_d, 3.0 - 1.5 * np.exp(-1.0))


def test_pictures_of_a_scale_have_noise_of_their_own() -> None:
    plant = EyePlant(replace(CONFIG, noise=NoiseConfig(picture_sd=5.0)), STIMULI)
    noisy = looked(plant, 3.0, 3.0).apart[0].astype(float)
    clear = looked(plant, 3.0, 3.0, **{"noise.picture_sd": 0.0}).apart[0]
    assert (noisy - clear).std() == pytest.approx(5.0, rel=0.1)
    plant.close()


def test_messages_have_lenses_and_pictures_of_scales(plant: EyePlant) -> None:
    seen = looked(plant, 1.0, 3.0)
    messages = ObservationMessages(CONFIG)
    vectors = {t: d for t, d in messages.vectors(7, seen) if t != "/clock"}
    eyes = read_vector(vectors["eye_states"], "eye_states")
    assert tuple(eyes.name) == eye_state_names(CONFIG.space)
    assert eyes.name[6:9] == ["left_accommodation_d", "left_focus_d", "left_pupil_m"]
    np.testing.assert_allclose(eyes.position[6:], [1.0, 1.0, 0.004, 3.0, 3.0, 0.004])
    felt = read_vector(vectors["muscle_activations"], "muscle_activations")
    assert felt.name[12:] == [
        "left_ciliary",
        "left_sphincter",
        "right_ciliary",
        "right_sphincter",
    ]
    assert felt.position[14] == pytest.approx(3.0 * ONE_D)
    assert eye_state_names(COMMAND_SPACES[PAIR]) == EYE_STATE_NAMES
    pictures = dict(messages.apart(7, seen))
    assert list(pictures) == ["left/foveal/image_raw", "right/foveal/image_raw"]
    for message, picture in zip(pictures.values(), seen.apart[0], strict=True):
        np.testing.assert_array_equal(image_array(message), picture)


def test_copies_see_the_same(plant: EyePlant) -> None:
    expected = looked(plant, 3.0, 1.0)
    for other in (copy.deepcopy(plant), pickle.loads(pickle.dumps(plant))):
        seen = looked(other, 3.0, 1.0)
        np.testing.assert_array_equal(seen.pictures, expected.pictures)
        np.testing.assert_array_equal(seen.apart, expected.apart)


def test_what_eyes_without_lenses_cannot_do_is_refused() -> None:
    plant = EyePlant(WITHOUT_LENSES, STIMULI)
    with pytest.raises(InputError, match="activations: expected 12 of eyes without lenses, got 16"):
        plant.begin(Episode.alone(0, 1.0, (*START, 0.0, 0.0, 0.0, 0.0), 3))
    plant.begin(Episode.alone(0, 1.0, START, 3))
    with pytest.raises(InputError, match="unknown muscle 'ciliary'"):
        plant.targets(["ciliary"], np.array([0.1]))
    plant.close()


def test_short_commands_and_other_renderers_are_refused(plant: EyePlant) -> None:
    plant.reconfigure({})
    plant.begin(Episode.alone(0, 1.0, START, 3))
    with pytest.raises(InputError, match="expected 4 activations of lenses and pupils"):
        plant.execute(np.array(START))
    mujoco = replace(CONFIG, camera=CameraConfig(renderer="mujoco"))
    with pytest.raises(InputError, match=r"camera\.renderer: expected plane, which draws foveal"):
        EyePlant(mujoco, STIMULI)
