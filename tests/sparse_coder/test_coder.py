import dataclasses
from typing import Any

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from lockstep import InputError
from lockstep.randomness import Moment
from lockstep.scales import ScalesConfig
from sparse_coder import SparseCoder, SparseCoderConfig
from sparse_coder.dictionary import learned_atoms
from tests.sparse_coder.slow import slow_patches, slow_pursuit

Pair = tuple[NDArray[np.uint8], NDArray[np.uint8]]

SMALL = SparseCoderConfig(n_bases=40, n_selections=5)
WITH_LENS = dataclasses.replace(
    SMALL,
    command_space="pair_and_lens",
    lowest_activations=(0.0,),
    highest_activations=(0.2, 0.1, 0.4),
    scales=ScalesConfig(n_for_lenses=1),
)
FOLLOWING = dataclasses.replace(SMALL, plasticity_iterations=4, suppression_iterations=4)


def test_the_whole_code_matches_a_slow_one(stereo_pair: Pair) -> None:
    coder = SparseCoder(SMALL)
    encoding = coder.encode(*stereo_pair)
    crops = [p[56:184, 96:224].astype(np.float64) for p in stereo_pair]
    coarse = [np.asarray(cv2.pyrDown(cv2.pyrDown(crop)), np.float64) for crop in crops]
    fine = [p[100:140, 140:180].astype(np.float64) for p in stereo_pair]
    for scale, windows in enumerate((coarse, fine)):
        patches, atoms = slow_patches(*windows), coder.atoms()[scale].astype(np.float64)
        chosen, residuals = slow_pursuit(patches, atoms, 5)
        expected = np.zeros(40)
        for patch, ks, residual in zip(patches, chosen, residuals, strict=True):
            # With 5 of 40 atoms independent, the coefficients are the only ones that fit.
            used = sorted(set(ks))
            kappas = np.linalg.lstsq(atoms[used].T, patch - residual, rcond=None)[0]
            expected[used] += kappas**2
        np.testing.assert_allclose(encoding.features[scale], expected / len(patches), atol=1e-5)
        error = np.sum(residuals**2) / np.sum(patches**2)
        assert encoding.reconstruction_error[scale] == pytest.approx(error, abs=1e-5)


def test_encoding_changes_nothing_and_repeats_bit_for_bit(stereo_pair: Pair) -> None:
    coder = SparseCoder(SMALL)
    before = coder.state()
    first, second = coder.encode(*stereo_pair), coder.encode(*stereo_pair)
    np.testing.assert_array_equal(first.features, second.features)
    np.testing.assert_array_equal(first.reconstruction_error, second.reconstruction_error)
    assert not np.shares_memory(first.features, second.features)
    for name, array in coder.state().items():
        np.testing.assert_array_equal(array, before[name])


@pytest.mark.parametrize("sensor_sd", [0.0, 2.0])
def test_eyes_with_lenses_are_told_nothing_of_disparity_while_one_is_covered(
    stereo_pair: Pair, sensor_sd: float
) -> None:
    noise = np.random.default_rng(1).normal(128.0, sensor_sd, stereo_pair[1].shape)
    covered = stereo_pair[0], np.rint(noise).astype(np.uint8)
    without = SparseCoder(SMALL).encode(*covered)
    assert without.features.any(axis=1).all()
    coder = SparseCoder(WITH_LENS)
    assert coder.encode(*stereo_pair).features.any(axis=1).all()
    encoding = coder.encode(*covered)
    assert encoding.features.any(axis=1).tolist() == [False, True]
    # They are rewarded, and the dictionaries learn, as ever.
    assert encoding.reconstruction_error[0] == without.reconstruction_error[0]
    before = coder.atoms()
    coder.learn(encoding)
    assert (coder.atoms() != before).any(axis=(1, 2)).all()


def test_learning_lowers_the_error_at_both_scales(stereo_pair: Pair) -> None:
    coder = SparseCoder(SMALL)
    before = coder.encode(*stereo_pair).reconstruction_error
    for _ in range(50):
        coder.learn(coder.encode(*stereo_pair))
    assert coder.learning_steps == 50
    assert np.all(coder.encode(*stereo_pair).reconstruction_error < 0.7 * before)
    np.testing.assert_allclose(np.linalg.norm(coder.atoms(), axis=2), 1.0, atol=1e-6)


def test_dictionaries_come_to_rest_as_training_ends(stereo_pair: Pair) -> None:
    config = SparseCoderConfig(
        n_bases=40, n_training_iterations=4, iterations_per_episode=1, final_learning_rate_share=0.0
    )
    coder = SparseCoder(config)
    moved = []
    for _ in range(6):
        before = coder.atoms()
        coder.learn(coder.encode(*stereo_pair))
        moved.append(float(np.abs(coder.atoms() - before).max()))
    assert min(moved[:4]) > 0.0
    assert moved[4:] == [0.0, 0.0]


def test_the_price_rises_with_the_learning_steps() -> None:
    changes: dict[str, Any] = {
        "n_training_iterations": 10,
        "metabolic_cost_weight": 0.5,
        "price_rise_share": 0.4,
    }
    coder, lambdas = SparseCoder(dataclasses.replace(SMALL, **changes)), []
    for coder.learning_steps in range(6):
        lambdas.append(coder.lambda_by_now)
    assert lambdas == [0.0, 0.125, 0.25, 0.375, 0.5, 0.5]


def test_a_step_at_rate_zero_would_leave_the_bits_of_normalised_atoms(stereo_pair: Pair) -> None:
    # So a rested dictionary may be left alone: nobody can tell from the numbers.
    coder = SparseCoder(SparseCoderConfig(n_bases=40))
    for _ in range(3):
        coder.learn(coder.encode(*stereo_pair))
    encoding = coder.encode(*stereo_pair)
    for atoms, patches, selections in zip(
        coder.atoms(), encoding.patches, encoding.selections, strict=True
    ):
        same = learned_atoms(atoms, patches, selections, 0.0)
        assert same.tobytes() == atoms.tobytes()


def test_after_learning_equal_pictures_cost_less_than_shifted_ones(picture) -> None:
    coder = SparseCoder(SMALL)
    equal, other = picture[10:250, 10:330], picture[10:250, 20:340]
    for _ in range(50):
        coder.learn(coder.encode(equal, equal))
        coder.learn(coder.encode(other, other))
    held_out = picture[4:244, 14:334]
    together = coder.encode(held_out, held_out).reconstruction_error.sum()
    apart = coder.encode(held_out, picture[4:244, 8:328]).reconstruction_error.sum()
    assert together < 0.9 * apart


def test_seeds_and_scales_start_with_different_atoms() -> None:
    coarse, fine = SparseCoder(SMALL).atoms()
    other = SparseCoder(SparseCoderConfig(seed=2, n_bases=40)).atoms()[0]
    assert not np.any(coarse == fine)
    assert not np.any(coarse == other)


def test_flat_pictures_have_features_and_error_0() -> None:
    flat = np.full((240, 320), 90, np.uint8)
    coder = SparseCoder(SMALL)
    encoding = coder.encode(flat, flat)
    np.testing.assert_array_equal(encoding.features, 0.0)
    np.testing.assert_array_equal(encoding.reconstruction_error, 0.0)
    before = coder.atoms()
    coder.learn(encoding)
    np.testing.assert_array_equal(coder.atoms(), before)


@pytest.mark.parametrize("config", [SMALL, FOLLOWING])
def test_a_restored_coder_continues_bit_for_bit(
    stereo_pair: Pair, config: SparseCoderConfig
) -> None:
    coder = SparseCoder(config)
    for _ in range(3):
        coder.learn(coder.encode(*stereo_pair))
    state = coder.state()
    other = SparseCoder(dataclasses.replace(config, seed=9))
    other.restore(state)
    for _ in range(3):
        for one in (coder, other):
            one.learn(one.encode(*stereo_pair))
    assert other.learning_steps == 6
    np.testing.assert_array_equal(coder.atoms(), other.atoms())
    np.testing.assert_array_equal(
        coder.encode(*stereo_pair).features, other.encode(*stereo_pair).features
    )
    for name, array in coder.state().items():
        np.testing.assert_array_equal(array, other.state()[name])


def test_a_state_shares_no_memory_with_the_coder(stereo_pair: Pair) -> None:
    coder = SparseCoder(SMALL)
    state = coder.state()
    coder.restore(state)
    kept = coder.atoms()
    state["atoms"][:] = 7.0
    np.testing.assert_array_equal(coder.atoms(), kept)


def _with_nan(atoms: NDArray[np.float32]) -> NDArray[np.float32]:
    atoms[1, 2, 3] = np.nan
    return atoms


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda s: s | {"atoms": s["atoms"][:, 1:]}, r"atoms: expected .*\(2, 40, 128\), got"),
        (lambda s: s | {"atoms": s["atoms"].astype(np.float64)}, "atoms: expected float32"),
        (lambda s: s | {"atoms": _with_nan(s["atoms"])}, "atoms: expected unit norms, .* nan"),
        (lambda s: s | {"atoms": s["atoms"] * np.float32(1.01)}, "atoms: expected unit norms"),
        (lambda s: s | {"learning_steps": np.array(-1)}, "learning_steps: expected one count"),
        (lambda s: s | {"learning_steps": np.array(1.5)}, "learning_steps: expected one count"),
        (lambda s: s | {"dominances": np.zeros(3)}, r"dominances: expected .*\(130,\), got"),
        (lambda s: s | {"means_of_error": np.full(2, np.nan)}, "means_of_error: expected finite"),
        (lambda s: {"atoms": s["atoms"]}, "state: expected"),
        (lambda s: s | {"colour": np.array(1)}, "state: expected .*colour"),
    ],
)
def test_a_bad_state_is_refused_and_changes_nothing(change, message) -> None:
    coder = SparseCoder(FOLLOWING)
    before = coder.atoms()
    with pytest.raises(InputError, match=message):
        coder.restore(change(coder.state()))
    np.testing.assert_array_equal(coder.atoms(), before)
    assert coder.learning_steps == 0


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"n_bases": 0}, "n_bases: expected 1 or more, got 0"),
        ({"n_selections": 0}, "n_selections: expected 1 or more"),
        ({"learning_rate": -0.1}, "learning_rate: expected 0 or more, got -0.1"),
        ({"metabolic_cost_weight": float("nan")}, "metabolic_cost_weight: .*got nan"),
    ],
)
def test_bad_settings_are_refused(settings: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        SparseCoderConfig(**settings)


def test_a_random_reward_knows_nothing_of_pictures_and_rates(stereo_pair: Pair) -> None:
    coder = SparseCoder(dataclasses.replace(SMALL, random_reward=True, metabolic_cost_weight=0.5))
    left, right = stereo_pair
    one = coder.perceive(left, right, np.full(4, 0.1), moment=Moment(iteration=3))
    other = coder.perceive(right[::-1], left, np.full(4, 0.3), moment=Moment(iteration=3))
    assert one.encoding.reconstruction_error.sum() != other.encoding.reconstruction_error.sum()
    assert (one.reward, one.energy_penalty) == (other.reward, other.energy_penalty)
    coder.learn(one.encoding)
    assert (
        coder.perceive(left, right, np.full(4, 0.1), moment=Moment(iteration=3)).reward
        != one.reward
    )
