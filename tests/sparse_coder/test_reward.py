import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from lockstep import InputError
from lockstep.randomness import Moment
from lockstep.scales import ScalesConfig
from sparse_coder import SparseCoder, SparseCoderConfig
from sparse_coder.matching_pursuit import Selections, residuals_of_eyes
from sparse_coder.patches import FINE, patches_and_energies, window_of
from sparse_coder.reward import (
    information,
    lambda_by_now,
    noise_energy,
    random_reward,
    reconstruction_error,
    reward,
)
from sparse_coder.whitening import GAIN, whitened

WORTH = -0.4


def test_the_error_is_the_share_of_all_patches_energy_that_their_selections_leave() -> None:
    patches = np.array([[3.0, 4.0], [0.0, 5.0]], np.float32)  # of energy 50
    selections = Selections(np.array([[0], [1]], np.int32), np.array([[3.0], [4.0]], np.float32))
    assert reconstruction_error(patches, selections) == pytest.approx(25.0 / 50.0)


def test_information_is_how_many_times_the_code_makes_the_uncertain_smaller() -> None:
    """n + S is 8 and 2, n + R is 8 - 6 = 2 and 2: a mean of 0.5 log 4 and 0.5 log 1."""
    energies = np.array([[4.0, 3.0], [1.0, 0.0]])
    residuals = np.array([[0.25, 0.0], [1.0, 0.5]])
    assert information(energies, residuals, 1.0) == pytest.approx(0.25 * math.log(4.0))


def test_information_of_what_noise_drowns_is_nothing() -> None:
    energies, residuals = np.full((3, 2), 2.0), np.zeros((3, 2))
    assert information(energies, residuals, 1e9) == pytest.approx(0.0, abs=1e-8)
    assert information(np.zeros((3, 2)), residuals, 1.0) == 0.0


def test_noise_of_a_patch_is_that_of_its_pixels_after_whitening() -> None:
    assert noise_energy(7.0, 0.5, 128) == pytest.approx(128 * 12.25)


def test_energies_are_those_of_each_eyes_part_without_its_mean() -> None:
    left, right = np.zeros((2, 8, 8), np.float32)
    left[:4], right[:, :2] = 2.0, 8.0
    _, energies = patches_and_energies(left, right)
    # 64 times the variance: 64 x 1 and 64 x (0.25 x 0.75 x 8^2).
    np.testing.assert_allclose(energies, [[64.0, 768.0]])


def test_residuals_are_those_of_each_eyes_half() -> None:
    patches = np.array([[0.6, 0.8, 1.0, 0.0]], np.float32)
    atoms = np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.6, 0.8]], np.float32)
    selections = Selections(np.array([[0, 1]], np.int32), np.array([[0.6, 0.5]], np.float32))
    # Left (0, 0.8); right (1 - 0.3, -0.4).
    np.testing.assert_allclose(
        residuals_of_eyes(patches, atoms, selections), [[0.64, 0.49 + 0.16]], rtol=1e-6
    )


LENSES: dict[str, Any] = {
    "command_space": "pair_and_lens",
    "lowest_activations": (0.0,),
    "highest_activations": (0.2,),
    "scales": ScalesConfig(("a", "b", "c"), (40,) * 3, (40,) * 3, (1.0,) * 3, (0.0,) * 3, 2),
    "iterations_per_episode": 20,
}


def test_the_eyes_are_rewarded_for_their_scales_then_lenses_for_information_of_theirs(
    picture: NDArray[np.uint8],
) -> None:
    config = SparseCoderConfig(
        n_bases=40, sensor_noise=(2.0, 5.0), metabolic_cost_weight=0.1, **LENSES
    )
    coder = SparseCoder(config)
    verging, focusing = (
        coder.perceive(picture, picture, np.full(4, 0.5), moment=Moment(iteration=i))
        for i in (9, 10)
    )
    encoding = focusing.encoding
    window = whitened(window_of(picture, FINE))
    _, energies = patches_and_energies(window, window)
    for i, sd in ((1, 2.0), (2, 5.0)):
        left = residuals_of_eyes(encoding.patches[i], coder.atoms()[i], encoding.selections[i])
        expected = information(energies, left, noise_energy(sd, GAIN, 128))
        assert encoding.information[i - 1] == pytest.approx(expected)
    assert focusing.reward == pytest.approx(encoding.information.sum() - 0.1 * 2.0)
    assert verging.reward == pytest.approx(-encoding.reconstruction_error[0] - 0.1 * 2.0)


def test_sensor_noise_has_an_entry_for_each_scale_for_lenses_or_one_for_all() -> None:
    both = SparseCoderConfig(sensor_noise=(3.0,), **LENSES).noise_energies
    assert both == pytest.approx([1152.0 * GAIN**2] * 2)
    with pytest.raises(InputError, match="sensor_noise: expected 2 entries, of b, c, or one"):
        SparseCoderConfig(sensor_noise=(1.0, 2.0, 3.0), **LENSES)


def test_energy_is_charged_at_its_price() -> None:
    got = reward(WORTH, 1.4, 0.035)
    assert got.value == pytest.approx(-0.4 - 0.049)
    assert got.energy_penalty == pytest.approx(0.049)


@pytest.mark.parametrize("rate_w", np.random.default_rng(0).uniform(0.1, 2.0, 20))
def test_reward_and_penalty_make_the_error_to_the_last_bit(rate_w: float) -> None:
    got = reward(WORTH, rate_w, 0.065)
    assert got.value + got.energy_penalty == -0.4


@pytest.mark.parametrize("rate_w", [math.nan, math.inf, -0.1])
def test_a_bad_metabolic_rate_is_refused(rate_w: float) -> None:
    with pytest.raises(InputError, match="metabolic rate: expected 0 W or more"):
        reward(WORTH, rate_w, 0.0)


def test_a_price_rises_from_0_or_is_constant() -> None:
    assert [lambda_by_now(0.5, n, 4.0) for n in range(6)] == [0.0, 0.125, 0.25, 0.375, 0.5, 0.5]
    assert lambda_by_now(0.5, 0, 0.0) == 0.5


def test_random_rewards_differ_by_seed_and_time_alone() -> None:
    times = [(n, i) for n in range(30) for i in range(10)]
    drawn = [random_reward(1, *at).value for at in times]
    assert drawn == [random_reward(1, *at).value for at in times]
    assert len({*drawn, *(random_reward(2, *at).value for at in times)}) == 600
    assert -1.0 <= min(drawn) < -0.95
    assert -0.05 < max(drawn) <= 0.0
    assert random_reward(1, 0, 0).energy_penalty == 0.0
