import numpy as np
import pytest

from vergence_rl.gaze.eye_turns import EyeTurns

LOWEST, HIGHEST = np.zeros(4), np.full(4, 0.2)
# Degrees per unit of activation, of an eye with four muscles.
SLOPES = np.array([[450.0, -420.0, 20.0, 30.0], [-70.0, 60.0, 300.0, -370.0], [5.0, 9.0, 40, 50]])


def turned_deg(before, change):
    """An eye whose place bends with the activations: f(a + d) - f(a) for f of third degree."""

    def place(a):
        rest = a - 0.1
        return SLOPES @ (rest + 1.5 * rest**2 + 4.0 * rest**3 + 2.0 * rest * rest[::-1])

    return place(before + change) - place(before)


def learned(n: int, memory_share: float = 0.0) -> EyeTurns:
    draw, eye = np.random.default_rng(1), EyeTurns(LOWEST, HIGHEST, memory_share)
    for _ in range(n):
        before, change = draw.uniform(0.02, 0.18, 4), draw.normal(0.0, 0.01, 4)
        eye.learn(before, change, turned_deg(before, change))
    return eye


def test_what_a_change_does_is_learned_to_the_third_order() -> None:
    eye, draw = learned(2000), np.random.default_rng(2)
    for _ in range(20):
        before, change = draw.uniform(0.02, 0.18, 4), draw.normal(0.0, 0.01, 4)
        expected = turned_deg(before, change)
        np.testing.assert_allclose(eye.turns_deg(before, change), expected, atol=0.02)


def test_the_change_for_a_wanted_turn_leads_there() -> None:
    eye, draw = learned(2000), np.random.default_rng(3)
    for _ in range(20):
        before, wanted = draw.uniform(0.06, 0.14, 4), draw.uniform(-3.0, 3.0, 3)
        wanted[2] /= 10.0
        change = eye.change_for(before, wanted)
        np.testing.assert_allclose(turned_deg(before, change), wanted, atol=0.02)


def test_a_muscle_at_its_limit_is_made_up_for_by_the_others() -> None:
    eye, before = learned(2000), np.array([0.1, 0.002, 0.1, 0.1])
    wanted = np.array([4.0, 0.0, 0.0])  # the second muscle would relax
    change = eye.change_for(before, wanted)
    assert 0.0 <= before[1] + change[1] < 0.001
    np.testing.assert_allclose(turned_deg(before, change), wanted, atol=0.05)


def test_nothing_is_known_at_first_and_nothing_moves_where_nothing_is_wanted() -> None:
    before = np.full(4, 0.1)
    assert not EyeTurns(LOWEST, HIGHEST).change_for(before, np.array([1.0, 2.0, 3.0])).any()
    assert not learned(50).change_for(before, np.zeros(3)).any()


def lost_a_muscle_deg(before, change):
    """Return what a change does to the same eye once its first muscle has no strength."""
    return turned_deg(np.append(0.1, before[1:]), np.append(0.0, change[1:]))


@pytest.mark.parametrize("memory_share", [0.0, 0.15])
def test_an_eye_that_has_changed_is_known_again_by_a_memory_that_ends(memory_share) -> None:
    eye, draw = learned(3000, memory_share), np.random.default_rng(5)
    for _ in range(12000):
        before, change = draw.uniform(0.02, 0.18, 4), draw.normal(0.0, 0.01, 4)
        eye.learn(before, change, lost_a_muscle_deg(before, change))
    before, change = np.full(4, 0.1), np.array([0.02, 0.0, 0.0, 0.0])
    error = np.abs(eye.turns_deg(before, change) - lost_a_muscle_deg(before, change)).max()
    # A fifth of all movements were those of the healthy eye, which this turns by 9 deg.
    assert error < 0.1 if memory_share else error > 1.0


@pytest.mark.parametrize(("memory_share", "memory"), [(0.0, np.inf), (0.5, 2000.0), (500.0, None)])
def test_the_regression_is_that_of_all_movements_at_once(memory_share, memory) -> None:
    draw, eye = np.random.default_rng(4), EyeTurns(LOWEST[:1], HIGHEST[:1], memory_share)
    rows, turns = [], []
    weights: list[float] = []
    for n in range(30):
        kept = np.exp(-1.0 / (memory or max(2000.0, memory_share * n)))
        weights = [kept * weight for weight in weights] + [1.0]
        before, change, turn = draw.uniform(0, 0.2, 1), draw.normal(0, 0.01, 1), draw.normal(size=3)
        eye.learn(before, change, turn)
        half_way = (before[0] + change[0] / 2.0) / 0.1 - 1.0
        rows.append(change[0] / 0.01 * np.array([1.0, half_way, half_way**2]))
        turns.append(turn)
    x, y, w = np.array(rows), np.array(turns), np.diag(weights)
    penalty = 1e-5 * np.mean(np.diag(x.T @ w @ x)) * np.eye(3)
    solved = np.linalg.inv(x.T @ w @ x + penalty) @ x.T @ w @ y
    got = eye.turns_deg(np.array([0.1]), np.array([0.02]))
    np.testing.assert_allclose(got, 2.0 * np.array([1.0, 0.1, 0.01]) @ solved, rtol=1e-9)
