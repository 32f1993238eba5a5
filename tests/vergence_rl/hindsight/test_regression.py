import numpy as np
import pytest
from numpy.typing import NDArray

from vergence_rl.hindsight.regression import (
    Sums,
    first_sums,
    nearness,
    regressed_actor,
    residual_covariance,
    weights_of_ranks,
)

N_STATE, N_MUSCLES, N_VISITS = 5, 2, 10


def episodes(n: int) -> list[tuple[NDArray[np.float64], ...]]:
    """States, targets that depend on them, and weights of some episodes."""
    draw = np.random.default_rng(3)
    mapping = draw.standard_normal((N_STATE, N_MUSCLES))
    found: list[tuple[NDArray[np.float64], ...]] = []
    for _ in range(n):
        states = draw.standard_normal((N_VISITS, N_STATE))
        noise = draw.standard_normal((N_VISITS, N_MUSCLES)) @ np.array([[0.3, 0.1], [0.0, 0.2]])
        found.append((states, states @ mapping + noise, draw.uniform(0.1, 1.0, N_VISITS)))
    return found


def summed(n: int, kept: float, first: Sums) -> Sums:
    for states, targets, weights in episodes(n):
        first.add(states, targets, weights, kept=kept)
    return first


def stored(n: int, kept: float) -> tuple[NDArray[np.float64], ...]:
    """The same episodes end to end, each visit's weight times what is left of it."""
    parts = [(s, t, w * kept ** (n - 1 - i)) for i, (s, t, w) in enumerate(episodes(n))]
    return tuple(np.concatenate(column) for column in zip(*parts, strict=True))


def test_visits_are_added_in_place_with_the_bits_of_a_plain_sum() -> None:
    draw, n_state = np.random.default_rng(5), 803
    sums = first_sums(n_state, 0.0 * np.eye(N_MUSCLES), 0.0)
    expected = np.zeros((n_state, n_state))
    for _ in range(3):
        states, targets = draw.normal(size=(10, n_state)), draw.normal(size=(10, N_MUSCLES))
        sums.add(states, targets, np.ones(10), kept=0.9)
        expected = 0.9 * expected + states.T @ states
    np.testing.assert_array_equal(sums.squares, expected)
    np.testing.assert_array_equal(sums.squares, sums.squares.T)


@pytest.mark.parametrize(
    "ridge_shares", [np.full(N_STATE, 1e-9), np.array([0.05, 0.05, 0.05, 0.2, 0.0])]
)
@pytest.mark.parametrize("kept", [1.0, 0.9])
def test_the_actor_is_the_least_squares_solution_of_all_stored_visits(kept, ridge_shares) -> None:
    sums = summed(20, kept, first_sums(N_STATE, 0.0 * np.eye(N_MUSCLES), 0.0))
    states, targets, weights = stored(20, kept)
    root = np.sqrt(weights)[:, None]
    ridges = ridge_shares * np.mean(((root * states) ** 2).sum(axis=0))
    rows = np.concatenate([root * states, np.diag(np.sqrt(ridges))])
    aims = np.concatenate([root * targets, np.zeros((N_STATE, N_MUSCLES))])
    expected = np.linalg.lstsq(rows, aims, rcond=None)[0].T
    np.testing.assert_allclose(regressed_actor(sums, ridge_shares), expected, rtol=1e-8)


def test_the_covariance_is_that_of_the_residuals_of_all_stored_visits() -> None:
    sums = summed(20, 0.9, first_sums(N_STATE, 0.0 * np.eye(N_MUSCLES), 0.0))
    states, targets, weights = stored(20, 0.9)
    actor = np.random.default_rng(4).standard_normal((N_MUSCLES, N_STATE))
    residuals = targets - states @ actor.T
    expected = np.cov(residuals.T, aweights=weights, ddof=0)
    expected += np.outer(*2 * [np.average(residuals, axis=0, weights=weights)])
    np.testing.assert_allclose(residual_covariance(sums, actor), expected, rtol=1e-10)


def test_without_visits_the_actor_does_nothing_and_residuals_scatter_as_told() -> None:
    sums = first_sums(N_STATE, 0.04 * np.eye(N_MUSCLES), 7.0)
    actor = regressed_actor(sums, np.full(N_STATE, 0.01))
    np.testing.assert_array_equal(actor, np.zeros((N_MUSCLES, N_STATE)))
    np.testing.assert_allclose(residual_covariance(sums, actor), 0.04 * np.eye(N_MUSCLES))


def test_a_target_at_the_scale_counts_half() -> None:
    targets = np.array([[0.0, 0.0], [0.003, 0.004], [0.0, 0.015]])
    np.testing.assert_allclose(nearness(targets, 0.005), [1.0, 0.5, 0.1])


def test_weights_of_ranks_by_hand() -> None:
    assert weights_of_ranks(1).tolist() == [1.0]
    # ln 2.5 = 0.9163 and ln 2.5 - ln 2 = 0.2231, of 1.1394.
    assert weights_of_ranks(2) == pytest.approx([0.8042, 0.1958], abs=1e-4)
    # ln 3.5, ln 1.75, ln 1.1667: 1.2528, 0.5596, 0.1542, of 1.9666.
    assert weights_of_ranks(3) == pytest.approx([0.6370, 0.2846, 0.0784], abs=1e-4)
