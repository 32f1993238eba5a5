import numpy as np
import pytest

from vergence_rl.gaze.descent import HALF, change_for, lowered, slopes_half_way

LIMITS = np.zeros(3), np.full(3, 0.2)


def slow_slopes(weights, middle):
    places = np.concatenate([[1.0], middle, np.outer(middle, middle)[np.triu_indices(len(middle))]])
    return weights @ places


def slow_change(weights, a, d, wanted_deg, limits):
    """The same by general least squares, with the muscles that are free picked out."""
    for _ in range(8):
        slopes = slow_slopes(weights, a + HALF * d)
        left_deg = wanted_deg - slopes @ d
        if np.abs(left_deg).max() < 1e-4:
            break
        free = np.ones(len(d), bool)
        while free.any():
            step = np.zeros_like(d)
            step[free] = np.linalg.lstsq(slopes[:, free], left_deg)[0]
            stepped = np.clip(d + step, *limits)
            held = free & (stepped != d + step)
            left_deg, d = left_deg - slopes @ (stepped - d), stepped
            if not held.any():
                break
            free &= ~held
    return d


def slow_lowered(activations, slopes, held, limits, largest):
    """The same with the null space of the held angles from a pseudo-inverse."""
    change, free = np.zeros_like(activations), np.ones(len(activations), bool)
    while free.any():
        angles = held * free
        down = np.where(free, np.linalg.pinv(angles, rcond=1e-9) @ (angles @ slopes) - slopes, 0.0)
        if np.abs(down).max() <= 1e-9 * np.abs(slopes).max():
            break
        ends = np.where(down < 0, np.maximum(limits[0] - activations, -largest), largest)
        ends = np.where(down > 0, np.minimum(limits[1] - activations, largest), ends) - change
        reach = np.where(down != 0.0, ends / np.where(down != 0.0, down, 1.0), np.inf)
        first = int(np.maximum(reach, 0.0).argmin())
        change = change + max(reach[first], 0.0) * down
        if abs(change[first]) > 0.999999 * largest:
            break
        free[first] = False
    return change


@pytest.mark.parametrize("n_turns", [2, 3])
def test_a_change_is_that_of_general_least_squares(n_turns) -> None:
    draw, n_held = np.random.default_rng(1), 0
    for _ in range(200):
        weights = draw.normal(size=(n_turns, 6, 28)) * np.r_[1.0, np.full(27, 0.05)]
        a, near = draw.uniform(-1.0, 1.0, 6), draw.normal(0.0, 0.2, 6)
        limits = -draw.uniform(0.0, 2.0, 6), draw.uniform(0.0, 2.0, 6)
        near = np.clip(near, *limits)
        wanted_deg = draw.normal(size=n_turns)
        got = change_for(weights, a, near, wanted_deg, limits)
        expected = slow_change(weights, a, near, wanted_deg, limits)
        np.testing.assert_allclose(got, expected, atol=1e-5)
        n_held += bool(((got == limits[0]) | (got == limits[1])).any())
    assert n_held > 50


def test_slopes_are_those_of_the_products_of_the_place_half_way() -> None:
    draw = np.random.default_rng(2)
    weights, a, half = draw.normal(size=(3, 6, 28)), draw.normal(size=6), draw.normal(size=6)
    np.testing.assert_allclose(slopes_half_way(weights, a, half), slow_slopes(weights, a + half))


@pytest.mark.parametrize(("n_angles", "n"), [(3, 6), (5, 12)])
def test_what_is_lowered_is_that_of_the_null_space(n_angles: int, n: int) -> None:
    draw, limits = np.random.default_rng(4), (np.zeros(n), np.full(n, 0.2))
    for _ in range(200):
        held, slopes = draw.normal(size=(n_angles, n)), draw.uniform(0.1, 1.0, n)
        held[2] = held[0] - held[1] if draw.random() < 0.3 else held[2]
        start = np.maximum(draw.uniform(-0.05, 0.1, n), 0.0)
        got = lowered(start, slopes, held, limits, 0.02)
        expected = slow_lowered(start, slopes, held, limits, 0.02)
        np.testing.assert_allclose(got, expected, atol=1e-9)
        np.testing.assert_allclose(held @ got, 0.0, atol=1e-9)
        assert (start + got >= -1e-12).all()
        assert np.abs(got).max() <= 0.02 + 1e-12
        assert slopes @ got <= 0.0


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
