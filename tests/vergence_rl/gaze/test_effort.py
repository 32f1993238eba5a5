import numpy as np
import pytest

from vergence_rl.gaze.effort import Effort, lowered

LIMITS = np.zeros(3), np.full(3, 0.2)


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


@pytest.mark.parametrize(
    ("activations", "expected"),
    [
        # Antagonists relax together, as far as a step allows,
        ([0.1, 0.08, 0.0], [-0.04, -0.04, 0.0]),
        # or until one of them is silent.
        ([0.1, 0.02, 0.0], [-0.02, -0.02, 0.0]),
        ([0.1, 0.0, 0.0], [0.0, 0.0, 0.0]),
    ],
)
def test_antagonists_relax_until_one_is_silent(activations, expected) -> None:
    held = np.array([[1.0, -1.0, 0.0]])
    slopes = np.array([1.0, 1.0, 0.0])
    change = lowered(np.array(activations), slopes, held, LIMITS, 0.04)
    np.testing.assert_allclose(change, expected, atol=1e-12)


def test_when_a_muscle_is_silent_the_others_go_on() -> None:
    # Muscles 0 and 1 pull alike against 2; 0 is the dearer one, and 1 takes over from it.
    held = np.array([[1.0, 1.0, -1.0]])
    slopes = np.array([3.0, 1.0, 1.0])
    start = np.array([0.01, 0.1, 0.11])
    change = lowered(start, slopes, held, LIMITS, 0.04)
    assert start[0] + change[0] == pytest.approx(0.0, abs=1e-12)
    assert change[2] == pytest.approx(-0.04)
    np.testing.assert_allclose(held @ change, 0.0, atol=1e-12)


def test_what_is_lowered_is_held_allowed_and_cheaper() -> None:
    draw = np.random.default_rng(3)
    for _ in range(50):
        held, slopes = draw.normal(size=(5, 12)), draw.uniform(0.1, 1.0, 12)
        start = np.maximum(draw.uniform(-0.05, 0.1, 12), 0.0)
        limits = np.zeros(12), np.full(12, 0.2)
        change = lowered(start, slopes, held, limits, 0.02)
        np.testing.assert_allclose(held @ change, 0.0, atol=1e-9)
        assert (start + change >= -1e-12).all()
        assert np.abs(change).max() <= 0.02 + 1e-12
        assert slopes @ change <= 0.0


def test_goes_on_from_its_state_bit_for_bit() -> None:
    whole, part = learned(2500), Effort(3)
    part.restore(whole.state())
    for effort in (whole, part):
        effort.learn(np.full(3, 0.03), 0.2)
    a = np.array([0.05, 0.1, 0.15])
    assert whole.slopes(a).tobytes() == part.slopes(a).tobytes()
