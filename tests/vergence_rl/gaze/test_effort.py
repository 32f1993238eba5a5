import numpy as np

from vergence_rl.gaze.effort import Effort


def learned(n: int, shares=(0.5, 1.0, 0.2)) -> Effort:
    draw, effort = np.random.default_rng(1), Effort(3)
    for _ in range(n):
        a = draw.uniform(0.0, 0.2, 3)
        effort.learn(a, float(np.dot(shares, a**0.6)) + 0.1)
    return effort


def test_the_slopes_of_a_price_are_learned() -> None:
    a = np.array([0.05, 0.1, 0.15])
    expected = np.array([0.5, 1.0, 0.2]) * 0.6 * a**-0.4
    np.testing.assert_allclose(learned(3000).slopes(a), expected, rtol=0.1)
    # Steepest where a muscle is nearly silent, and finite there.
    at_rest = learned(3000).slopes(np.zeros(3))
    assert (at_rest > 1.5 * expected).all()
    assert np.isfinite(at_rest).all()


def test_little_is_known_at_first_and_without_a_price_nothing_costs() -> None:
    np.testing.assert_array_equal(learned(1999).slopes(np.full(3, 0.1)), 0.0)
    free = Effort(3)
    for _ in range(2500):
        free.learn(np.full(3, 0.1), 0.0)
    np.testing.assert_array_equal(free.slopes(np.zeros(3)), 0.0)


def test_a_price_that_changes_is_followed() -> None:
    effort, draw = learned(3000), np.random.default_rng(2)
    for _ in range(12000):
        a = draw.uniform(0.0, 0.2, 3)
        effort.learn(a, float(a.sum()))
    np.testing.assert_allclose(effort.slopes(np.full(3, 0.1)), 1.0, rtol=0.05)
