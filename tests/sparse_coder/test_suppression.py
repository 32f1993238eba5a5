"""Suppression: fused halves are shared, rival ones go to one eye, and E falls on the way."""

import dataclasses

import numpy as np
import pytest
from numpy.typing import NDArray

from sparse_coder import SparseCoder, SparseCoderConfig
from sparse_coder.suppression import MOST, gains, learned_dominance, with_gains

_STEP = 1e-4
_DRAW = np.random.default_rng(3)
_LEFT, _RIGHT = (v / np.linalg.norm(v) for v in _DRAW.standard_normal((2, 64)))
_NOTHING = np.zeros(64)


def _coded(patch: NDArray[np.float32], atoms: list[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return the best code of a patch (128,) with one of the atoms."""
    return max((patch @ a * a for a in atoms), key=np.linalg.norm)


def _error(dominance: float, patch: NDArray[np.float32], atoms: list[NDArray[np.float64]]) -> float:
    gained = with_gains(patch[None], np.array([dominance]))[0].astype(np.float64)
    return float(np.sum((gained - _coded(gained, atoms)) ** 2) / 2.0)


def _moved(dominance: float, patch: NDArray[np.float32], atoms: list[NDArray[np.float64]]) -> float:
    """Return how far an iteration moves d, times tau."""
    gained = with_gains(patch[None], np.array([dominance]))
    coded = _coded(gained[0], atoms).astype(np.float32)[None]
    after = learned_dominance(np.array([dominance]), gained, coded, np.full((1, 2), 9.0), 100)
    return 100.0 * float(after[0] - dominance)


_JOINT = [np.append(_LEFT, _LEFT) / np.sqrt(2.0)]
_OWN = [np.append(_LEFT, _NOTHING), np.append(_NOTHING, _RIGHT)]
_SAME = np.append(_LEFT, _LEFT).astype(np.float32)
_OTHER = np.append(_LEFT, _RIGHT).astype(np.float32)


@pytest.mark.parametrize(("patch", "atoms"), [(_SAME, _JOINT), (_OTHER, _OWN)])
@pytest.mark.parametrize("dominance", [-0.6, 0.1, 0.5])
def test_dominance_goes_down_the_slope_of_the_error(patch, atoms, dominance) -> None:
    above, below = (_error(dominance + step, patch, atoms) for step in (_STEP, -_STEP))
    slope = (above - below) / (2.0 * _STEP)
    # Of equal contrasts each eye has half of the weight. Images that are alike release an eye.
    alike = max(0.0, float(patch[:64] @ patch[64:]))
    moved = _moved(dominance, patch, atoms)
    assert moved == pytest.approx(-slope - 0.2 * alike * dominance, rel=1e-2)


def test_fused_images_are_shared_again_and_rival_ones_are_not() -> None:
    assert _moved(0.0, _SAME, _JOINT) == pytest.approx(0.0, abs=1e-4)
    for dominance in (0.2, 0.8):
        assert _moved(dominance, _SAME, _JOINT) < 0.0 < _moved(dominance, _OTHER, _OWN)
        assert _moved(-dominance, _OTHER, _OWN) < 0.0 < _moved(-dominance, _SAME, _JOINT)


def test_contrast_weighs_and_nothing_counts_nothing() -> None:
    patches = np.stack([_SAME, _SAME, np.zeros(128, np.float32)])
    energies = np.array([[9.0, 1.0], [0.0, 0.0], [9.0, 1.0]])
    after = learned_dominance(np.zeros(3), patches, patches, energies, 10)
    np.testing.assert_allclose(after, [0.08, 0.0, 0.0], atol=1e-6)
    assert learned_dominance(np.array([MOST]), _OTHER[None], _OTHER[None], energies[:1], 1) == MOST


def test_gains_keep_the_energy_of_a_patch() -> None:
    dominance = np.array([0.0, 0.5, -MOST])
    np.testing.assert_allclose((gains(dominance) ** 2).sum(axis=1), 2.0)
    np.testing.assert_allclose(gains(dominance)[1], np.sqrt([1.5, 0.5]))
    one = with_gains(np.tile(_OTHER, (3, 1)), dominance)
    np.testing.assert_allclose((one**2).sum(axis=1), 2.0, rtol=1e-5)
    np.testing.assert_array_equal(one[0], _OTHER)


def test_an_eye_that_is_covered_for_long_is_suppressed_at_every_place(stereo_pair) -> None:
    config = SparseCoderConfig(n_bases=40, n_selections=5, suppression_iterations=20)
    coder, (left, _) = SparseCoder(config), stereo_pair
    for _ in range(60):
        coder.learn(coder.encode(left, np.zeros_like(left)))
    for dominance in coder.dominances:
        assert dominance.min() > 0.3
    equal = SparseCoder(dataclasses.replace(config, suppression_iterations=0))
    equal.restore({name: coder.state()[name] for name in ("atoms", "learning_steps")})
    fresh, kept = (one.encode(*stereo_pair).patches for one in (equal, coder))
    for one, other in zip(fresh, kept, strict=True):
        assert (np.abs(other[:, 64:]) <= np.abs(one[:, 64:])).all()
