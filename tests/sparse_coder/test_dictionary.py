import numpy as np
import pytest
from numpy.typing import NDArray

from sparse_coder.dictionary import (
    Dictionary,
    dictionary_rate,
    initial_atoms,
    learned_atoms,
    learned_means,
    plasticity,
)
from sparse_coder.matching_pursuit import Selections, matching_pursuit
from sparse_coder.reward import reconstruction_error

SELECTIONS = Selections(
    np.array([[0, 2, 0], [2, 1, 1]], np.int32),
    np.array([[1.0, 0.7, 0.5], [-0.4, -0.9, 0.3]], np.float32),
)


def small_problem() -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    draw = np.random.default_rng(0)
    return initial_atoms(draw, 4, 5), draw.standard_normal((2, 5)).astype(np.float32)


def loss(atoms: NDArray[np.float64], patches: NDArray[np.float32]) -> float:
    """Half the squared residuals, with the coefficients held fixed."""
    total = 0.0
    for patch, chosen, kappas in zip(
        patches, SELECTIONS.atoms, SELECTIONS.coefficients, strict=True
    ):
        reconstruction = sum(float(k) * atoms[i] for i, k in zip(chosen, kappas, strict=True))
        total += 0.5 * np.sum((patch.astype(np.float64) - reconstruction) ** 2)
    return total


def gradient(atoms: NDArray[np.float32], patches: NDArray[np.float32]) -> NDArray[np.float64]:
    """Central differences of the loss with respect to every entry of every atom."""
    step, slopes = 1e-5, np.zeros(atoms.shape)
    for index in np.ndindex(*atoms.shape):
        moved = atoms.astype(np.float64)
        moved[index] += step
        above = loss(moved, patches)
        moved[index] -= 2 * step
        slopes[index] = (above - loss(moved, patches)) / (2 * step)
    return slopes


@pytest.mark.parametrize(
    ("share", "done", "rate"),
    [(1.0, 0.7, 0.2), (0.0, 0.0, 0.2), (0.0, 0.75, 0.05), (0.5, 1.0, 0.1), (0.0, 1.0, 0.0)],
)
def test_the_rate_declines_linearly_to_its_share(share: float, done: float, rate: float) -> None:
    assert dictionary_rate(0.2, share, done) == pytest.approx(rate)


def test_plasticity_ends_as_learning_does_and_comes_back_with_a_change() -> None:
    assert plasticity(np.array([0.9, 1.0])) == pytest.approx(1.0)
    assert plasticity(np.array([1.05, 1.0])) == pytest.approx(0.25)
    assert plasticity(np.zeros(2)) == 0.0
    means, found = np.array([0.0, 2.0]), []
    for error in [0.4] * 1000 + [0.5] * 10:
        means = learned_means(means, error, 100)
        found.append(plasticity(means))
    assert found[0] == 1.0
    # After n iterations the slow mean lacks (1 - 1/100)^n, the fast one (1 - 1/25)^n.
    slow, fast = 0.4 + 1.6 * 0.99**400, 0.4 - 0.4 * 0.96**400
    assert found[399] == pytest.approx(((slow - fast) / (0.1 * slow)) ** 2)
    assert found[999] < 1e-5
    assert found[-1] > 0.2


def test_step_is_down_the_gradient_then_normalised() -> None:
    atoms, patches = small_problem()
    expected = atoms - 0.2 / 2 * gradient(atoms, patches)
    expected /= np.linalg.norm(expected, axis=1, keepdims=True)
    got = learned_atoms(atoms, patches, SELECTIONS, 0.2)
    np.testing.assert_allclose(got, expected, atol=1e-6)


def test_an_atom_that_was_not_selected_keeps_its_bits() -> None:
    atoms, patches = small_problem()
    got = learned_atoms(atoms, patches, SELECTIONS, 0.2)
    np.testing.assert_array_equal(got[3], atoms[3])
    assert np.all(np.any(got[:3] != atoms[:3], axis=1))


def test_an_atom_that_would_vanish_stays() -> None:
    atoms = np.array([[1.0, 0.0]], np.float32)
    selections = Selections(np.array([[0]], np.int32), np.array([[1.0]], np.float32))
    got = learned_atoms(atoms, np.zeros((1, 2), np.float32), selections, 1.0)
    np.testing.assert_array_equal(got, atoms)


def test_learning_finds_the_directions_that_the_patches_share() -> None:
    draw = np.random.default_rng(4)
    directions = initial_atoms(draw, 6, 20)
    dictionary = Dictionary(initial_atoms(draw, 12, 20))
    errors = []
    for _ in range(400):
        patches = np.zeros((30, 20), np.float32)
        for i_patch in range(30):
            for i in draw.choice(6, 2, replace=False):
                patches[i_patch] += draw.standard_normal() * directions[i]
        selections = matching_pursuit(patches, dictionary.atoms, dictionary.gram, 2)
        errors.append(reconstruction_error(patches, selections))
        dictionary.replace(learned_atoms(dictionary.atoms, patches, selections, 0.2))
    assert np.mean(errors[-20:]) < 0.2 * errors[0]


def test_dictionary_holds_what_belongs_to_its_atoms() -> None:
    dictionary = Dictionary(initial_atoms(np.random.default_rng(1), 6, 5))
    other = initial_atoms(np.random.default_rng(2), 6, 5)
    dictionary.replace(other)
    np.testing.assert_allclose(dictionary.gram, other @ other.T, atol=1e-6)


def test_initial_atoms_are_uniform_unit_vectors() -> None:
    atoms = initial_atoms(np.random.default_rng(1), 400, 128)
    assert atoms.dtype == np.float32
    np.testing.assert_allclose(np.linalg.norm(atoms, axis=1), 1.0, atol=1e-6)
    # Uniform in [-0.5, 0.5]: a norm of sqrt(128 / 12) before, so no entry is above 0.5 over that.
    assert np.abs(atoms).max() == np.clip(np.abs(atoms).max(), 0.14, 0.18)
    assert abs(float(atoms.mean())) < 0.002
