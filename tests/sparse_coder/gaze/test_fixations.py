from dataclasses import replace

import cv2
import numpy as np
import pytest

from lockstep.optics import TurnNoiseConfig
from lockstep.randomness import Moment
from sparse_coder import Encoding
from sparse_coder.gaze.fixations import Fixations, Turns, with_noise
from sparse_coder.matching_pursuit import Selections
from sparse_coder.percept import NOT_GIVEN_DEG

FOCAL_PX = 250.0
SIDE_PX = 192
TARGET_DEG = np.array([3.0, -2.0])
# In the left and in the right picture.
GIVEN_DEG = np.array([TARGET_DEG, [-7.0, -1.0]])


def picture(right_px: float = 0.0, down_px: float = 0.0) -> np.ndarray:
    """What a camera sees that looks so many pixels aside of the middle of a texture."""
    noise = np.random.default_rng(5).normal(size=(400, 400)).astype(np.float32)
    smooth = cv2.GaussianBlur(noise, (0, 0), 3.0)
    texture = np.asarray(np.clip(128.0 + 50.0 * smooth / smooth.std(), 0, 255), np.uint8)
    left, top = (round(104.0 + shift_px) for shift_px in (right_px, down_px))
    return texture[top : top + SIDE_PX, left : left + SIDE_PX]


def encoding_with_worst(*i_patches: int) -> Encoding:
    """A code of unit patches of which it leaves all of some, the first most, and half of others."""
    patches = np.zeros((49, 128), np.float32)
    patches[:, 0] = 1.0
    coefficients = np.full((49, 1), np.sqrt(0.5), np.float32)
    for rank, i in enumerate(i_patches):
        coefficients[i] = 0.01 * rank
    selections = Selections(np.zeros((49, 1), np.int32), coefficients)
    nothing = np.zeros(0)
    return Encoding(
        np.zeros((2, 4), np.float32),
        np.zeros(2),
        (patches,) * 2,
        (selections,) * 2,
        nothing,
        (),
        np.zeros(1),
    )


NOTHING = encoding_with_worst()


def suppressing(dominance: float) -> Encoding:
    return replace(NOTHING, dominance=np.full(9, dominance))


def test_a_fixation_is_two_saccades_and_vergence() -> None:
    fixations, still = Fixations(7, FOCAL_PX), (picture(), picture())
    gazes = [fixations.step(Moment(iteration=i), still, NOTHING, GIVEN_DEG) for i in range(9)]
    np.testing.assert_array_equal(gazes[0].target_deg, TARGET_DEG)
    np.testing.assert_allclose(gazes[1].target_deg, TARGET_DEG, atol=0.01)
    np.testing.assert_allclose(gazes[1].turns_deg, 0.0, atol=0.01)
    for vergence in gazes[2:7]:
        assert np.isnan(vergence.target_deg).all()
    np.testing.assert_array_equal(gazes[7].target_deg, TARGET_DEG)
    assert np.isfinite(gazes[8].turns_deg).all()


def test_every_second_command_of_vergence_is_measured() -> None:
    fixations, ten_px_deg = Fixations(7, FOCAL_PX), np.degrees(np.arctan(10.0 / FOCAL_PX))
    # The left eye turns to the right with observation 3, back with 5, and to the right with 6.
    gazes = [
        fixations.step(
            Moment(iteration=i), (picture(10.0 * (i in (3, 4, 6))), picture()), NOTHING, GIVEN_DEG
        )
        for i in range(7)
    ]
    np.testing.assert_allclose(gazes[3].turns_deg, [[ten_px_deg, 0, 0], [0, 0, 0]], atol=0.05)
    np.testing.assert_allclose(gazes[5].turns_deg, [[-ten_px_deg, 0, 0], [0, 0, 0]], atol=0.05)
    assert all(np.isnan(gazes[i].turns_deg).all() for i in (2, 4, 6))


def test_the_second_saccade_is_to_what_the_first_has_missed() -> None:
    fixations = Fixations(5, FOCAL_PX)
    fixations.step(Moment(iteration=0), (picture(), picture()), NOTHING, GIVEN_DEG)
    # The left eye turns by 10 px to the right, the right one by 4 px up.
    gaze = fixations.step(
        Moment(iteration=1), (picture(10.0), picture(0.0, -4.0)), NOTHING, GIVEN_DEG
    )
    ten_px_deg, four_px_deg = np.degrees(np.arctan(np.array([10.0, 4.0]) / FOCAL_PX))
    np.testing.assert_allclose(gaze.turns_deg[0], [ten_px_deg, 0.0, 0.0], atol=0.05)
    np.testing.assert_allclose(gaze.turns_deg[1], [0.0, four_px_deg, 0.0], atol=0.05)
    np.testing.assert_allclose(gaze.target_deg, TARGET_DEG - [ten_px_deg, 0.0], atol=0.05)


FLAT = np.full((SIDE_PX, SIDE_PX), 9, np.uint8)


def test_the_right_eye_leads_when_it_suppresses_the_left_one() -> None:
    fixations = Fixations(5, FOCAL_PX)
    first, second, later = (
        fixations.step(Moment(iteration=i), pictures, suppressing(-0.2), GIVEN_DEG)
        for i, pictures in enumerate(
            [(picture(), picture()), (picture(10.0), picture(0.0, -4.0)), (picture(), picture())]
        )
    )
    assert (first.leading_eye, second.leading_eye, later.leading_eye) == (1, 1, 1)
    np.testing.assert_array_equal(first.target_deg, GIVEN_DEG[1])
    # It turned by 4 px up.
    four_px_deg = np.degrees(np.arctan(4.0 / FOCAL_PX))
    np.testing.assert_allclose(second.target_deg, GIVEN_DEG[1] - [0.0, four_px_deg], atol=0.05)


def test_an_eye_leads_for_all_of_a_fixation() -> None:
    fixations, still = Fixations(3, FOCAL_PX), (picture(), picture())
    dominances = (-0.05, -0.2, -0.2, -0.2, 0.2, 0.2, 0.2)
    gazes = [
        fixations.step(Moment(iteration=i), still, suppressing(dominance), GIVEN_DEG)
        for i, dominance in enumerate(dominances)
    ]
    assert [gaze.leading_eye for gaze in gazes] == [0, 0, 0, 1, 1, 1, 0]


@pytest.mark.parametrize(
    ("pictures", "dominance", "leads"),
    [((FLAT, picture()), 0.5, 1), ((picture(), FLAT), -0.5, 0), ((FLAT, FLAT), -0.5, 1)],
)
def test_an_eye_that_sees_nothing_does_not_lead(pictures, dominance, leads) -> None:
    gaze = Fixations(5, FOCAL_PX).step(Moment(), pictures, suppressing(dominance), GIVEN_DEG)
    assert gaze.leading_eye == leads


def test_after_an_unclear_movement_there_is_no_second_saccade() -> None:
    fixations = Fixations(5, FOCAL_PX)
    fixations.step(Moment(iteration=0), (picture(), picture()), NOTHING, GIVEN_DEG)
    gaze = fixations.step(Moment(iteration=1), (FLAT, picture()), NOTHING, GIVEN_DEG)
    assert np.isnan(gaze.target_deg).all()
    assert np.isnan(gaze.turns_deg[0]).all()
    assert np.isfinite(gaze.turns_deg[1]).all()


@pytest.mark.parametrize(
    ("i_patch", "right_px", "down_px"), [(0, -48, -48), (6, 48, -48), (27, 48, 0), (45, 0, 48)]
)
def test_eyes_that_may_choose_look_where_the_code_is_worst(i_patch, right_px, down_px) -> None:
    gaze = Fixations(5, FOCAL_PX).step(
        Moment(iteration=0), (picture(), picture()), encoding_with_worst(i_patch), NOT_GIVEN_DEG
    )
    angle = np.degrees(np.arctan(np.hypot(right_px, down_px) / FOCAL_PX))
    direction = np.array([right_px, -down_px]) / np.hypot(right_px, down_px)
    np.testing.assert_allclose(gaze.target_deg, angle * direction, atol=1e-9)


def test_they_do_not_return_to_where_they_have_looked_in_the_episode() -> None:
    fixations, still = Fixations(5, FOCAL_PX), (picture(), picture())
    first = fixations.step(Moment(iteration=0), still, encoding_with_worst(27, 24), NOT_GIVEN_DEG)
    assert first.target_deg[0] > 10.0
    # Both saccades lead there: what was 48 px to the right is ahead now, and what was ahead lies
    # 48 px to the left.
    fixations.step(Moment(iteration=1), (picture(48.0), picture(48.0)), NOTHING, NOT_GIVEN_DEG)
    second = fixations.step(
        Moment(iteration=5), still, encoding_with_worst(21, 24, 10), NOT_GIVEN_DEG
    )
    np.testing.assert_allclose(second.target_deg, np.degrees(np.arctan([0.0, 32.0 / 250.0])))
    again = fixations.step(
        Moment(iteration=0), still, encoding_with_worst(21, 24, 10), NOT_GIVEN_DEG
    )
    assert again.target_deg[0] < -10.0, "another episode is another scene"


def test_without_saccades_the_turns_of_two_commands_are_measured_and_no_target_is_chosen() -> None:
    turns, ten_px_deg = Turns(FOCAL_PX), np.degrees(np.arctan(10.0 / FOCAL_PX))
    gazes = [
        turns.step(
            Moment(iteration=i), (picture(10.0 * (i % 2)), picture()), NOTHING, NOT_GIVEN_DEG
        )
        for i in range(8)
    ]
    # From observation 0 to 1 the left eye turns to the right, from 5 to 6 back.
    np.testing.assert_allclose(gazes[1].turns_deg, [[ten_px_deg, 0, 0], [0, 0, 0]], atol=0.05)
    np.testing.assert_allclose(gazes[6].turns_deg, [[-ten_px_deg, 0, 0], [0, 0, 0]], atol=0.05)
    assert all(np.isnan(gazes[i].turns_deg).all() for i in (0, 2, 3, 4, 5, 7))
    assert all(np.isnan(gaze.target_deg).all() for gaze in gazes)


def test_turns_are_measured_with_noise_of_the_observation() -> None:
    noise, turns_deg = TurnNoiseConfig(turn_sd_deg=0.5), np.ones((2, 3))
    assert with_noise(turns_deg, TurnNoiseConfig(), 1, Moment()) is turns_deg
    errors_deg = np.array([with_noise(turns_deg, noise, 1, Moment(0, i)) - 1.0 for i in range(500)])
    assert errors_deg.std(axis=0) == pytest.approx(np.full((2, 3), 0.5), rel=0.15)
    assert errors_deg.mean() == pytest.approx(0.0, abs=0.05)
    np.testing.assert_array_equal(
        with_noise(turns_deg, noise, 1, Moment(0, 7)) - 1.0, errors_deg[7]
    )
    assert (with_noise(turns_deg, noise, 2, Moment(0, 7)) - 1.0 != errors_deg[7]).all()


def test_each_eye_misses_a_share_of_its_turns() -> None:
    noise = TurnNoiseConfig(missing_turns=0.2)
    turns_deg = np.array([with_noise(np.ones((2, 3)), noise, 1, Moment(0, i)) for i in range(500)])
    is_missing = np.isnan(turns_deg)
    np.testing.assert_array_equal(is_missing.all(axis=2), is_missing.any(axis=2))
    assert is_missing[:, :, 0].mean(axis=0) == pytest.approx([0.2, 0.2], abs=0.05)
    assert (is_missing[:, 0, 0] != is_missing[:, 1, 0]).any()
    assert (turns_deg[~is_missing] == 1.0).all()


def test_without_a_measured_turn_there_is_no_second_saccade() -> None:
    fixations = Fixations(5, FOCAL_PX, TurnNoiseConfig(missing_turns=1.0))
    fixations.step(Moment(iteration=0), (picture(), picture()), NOTHING, GIVEN_DEG)
    gaze = fixations.step(Moment(iteration=1), (picture(10.0), picture()), NOTHING, GIVEN_DEG)
    assert np.isnan(gaze.target_deg).all()
