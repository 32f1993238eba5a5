import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

from vergence_rl.hindsight.limits import freed_targets, within_limits

LOWEST, HIGHEST = np.zeros(2), np.array([0.2, 0.1])
# Both muscles together are ten times as free as one against the other.
TOGETHER = np.array([[1.01, 0.99], [0.99, 1.01]])
APART = np.diag([1.0, 4.0])


def test_where_one_muscle_ends_the_other_makes_up_for_it() -> None:
    # The lateral rectus cannot relax by 0.02 more: the medial one contracts by 0.99 / 1.01 of it.
    got = within_limits(np.array([0.05, -0.02]), TOGETHER, LOWEST, HIGHEST)
    np.testing.assert_allclose(got, [0.05 + 0.02 * 0.99 / 1.01, 0.0])


def test_no_residuals_make_up_for_nothing() -> None:
    got = within_limits(np.array([0.05, -0.02]), np.zeros((2, 2)), LOWEST, HIGHEST)
    np.testing.assert_allclose(got, [0.05, 0.0])


def test_a_muscle_that_cannot_change_stays_held() -> None:
    got = within_limits(np.array([0.2471, 0.0671]), TOGETHER, LOWEST, np.array([0.2, 0.0]))
    np.testing.assert_allclose(got, [0.2471 - 0.0671 * 0.99 / 1.01, 0.0])


def test_a_best_place_within_the_limits_is_the_target_of_all() -> None:
    best, wanted = np.array([0.1, 0.02]), np.array([[-0.1, -0.1], [0.3, 0.3], [0.1, 0.02]])
    targets = freed_targets(best, wanted, TOGETHER, LOWEST, HIGHEST)
    np.testing.assert_allclose(targets, [best, best, best])


def test_who_wants_to_go_beyond_a_limit_of_the_best_place_may_stay_there() -> None:
    best = np.array([0.05, 0.0])
    wanted = np.array([[0.02, -0.01], [0.02, 0.01], [0.0, -0.04]])
    targets = freed_targets(best, wanted, TOGETHER, LOWEST, HIGHEST)
    share = 0.99 / 1.01
    expected = [[0.05 - 0.01 * share, -0.01], [0.05, 0.0], [0.05 - 0.04 * share, -0.04]]
    np.testing.assert_allclose(targets, expected)
    # A command of such a target is the best place itself.
    for target in targets:
        np.testing.assert_allclose(within_limits(target, TOGETHER, LOWEST, HIGHEST), best)


def scattered(draw: np.random.Generator) -> NDArray[np.float64]:
    root = draw.normal(size=(12, 12)) / 100.0
    return root @ root.T


@pytest.mark.parametrize(
    ("covariance_of", "highest", "beyond", "oracles_error"),
    [
        (lambda _: TOGETHER, HIGHEST, 0.2, 1e-8),
        (lambda _: APART, HIGHEST, 0.2, 1e-8),
        (scattered, np.full(12, 0.2), 0.05, 1e-9),
    ],
)
def test_commands_are_the_nearest_that_there_are(
    covariance_of, highest, beyond, oracles_error
) -> None:
    """None is nearer in bounded least squares."""
    draw, lowest = np.random.default_rng(4), np.zeros_like(highest)
    for _ in range(50):
        covariance = covariance_of(draw)
        wanted = draw.uniform(lowest - beyond, highest + beyond)
        found = within_limits(wanted, covariance, lowest, highest)
        whitening = np.linalg.inv(np.linalg.cholesky(covariance))
        oracle = lsq_linear(whitening, whitening @ wanted, (lowest, highest), tol=1e-12).x
        far, least = (float(np.sum((whitening @ (c - wanted)) ** 2)) for c in (found, oracle))
        assert far <= least * (1.0 + 1e-9)
        assert far == pytest.approx(least, rel=oracles_error)
        assert (found >= lowest).all()
        assert (found <= highest).all()


def test_targets_of_many_muscles_free_those_beyond_their_limits() -> None:
    covariance = np.diag([1.0, 4.0, 9.0])
    covariance[0, 1] = covariance[1, 0] = 1.0
    best = np.array([0.0, 0.1, 0.2])
    wanted = np.array([[-0.1, 0.3, 0.3], [0.05, 0.3, 0.1], [-0.1, -0.1, 0.1]])
    found = freed_targets(best, wanted, covariance, np.zeros(3), np.full(3, 0.2))
    # The first stays beyond both limits that hold it, and the second muscle goes along with one of
    # them: cov / var = 1. Of the second visit nothing is held, of the third the first muscle is.
    assert found == pytest.approx(np.array([[-0.1, 0.0, 0.3], best, [-0.1, 0.0, 0.2]]))
