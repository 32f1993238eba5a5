import numpy as np
import pytest

from lockstep.errors import InputError
from vergence_rl.gaze.control import GazeControl, checked_gaze

LOWEST, HIGHEST = np.zeros(12), np.full(12, 0.2)
MID = np.full(12, 0.1)
# Degrees (right, up, clockwise) per unit of activation of the left eye's muscles; the right eye's
# medial and lateral rectus turn it the other way.
LEFT = np.array(
    [
        [450.0, -420.0, -30.0, 160.0, -20.0, -80.0],
        [-70.0, 70.0, 300.0, -370.0, -70.0, 90.0],
        [-13.0, 14.0, 47.0, -83.0, 43.0, -30.0],
    ]
)
RIGHT = LEFT * np.array([[-1.0], [1.0], [-1.0]])


def turned_deg(change: np.ndarray) -> np.ndarray:
    return np.array([LEFT @ change[:6], RIGHT @ change[6:]])


def learned(n: int = 400, *, seen: bool = True) -> GazeControl:
    """Eyes that turn in proportion to the change, having made n saccades of noise."""
    draw, control = np.random.default_rng(1), GazeControl(LOWEST, HIGHEST, 0.002)
    for _ in range(n):
        before = draw.uniform(0.08, 0.12, 12)
        after = control.saccade(before, np.zeros(2), draw)
        turns_deg = turned_deg(after - before)
        control.learn(after, turns_deg if seen else np.full((2, 3), np.nan))
    return control


def test_saccades_turn_both_eyes_alike_without_rotating_them() -> None:
    command = learned().saccade(MID, np.array([6.0, -3.0]), None)
    expected = [[6.0, -3.0, 0.0], [6.0, -3.0, 0.0]]
    np.testing.assert_allclose(turned_deg(command - MID), expected, atol=0.02)


def test_vergence_leaves_the_left_line_of_sight_and_the_right_eye_alone() -> None:
    wanted = MID + np.random.default_rng(2).normal(0.0, 0.01, 12)
    held = learned().held(MID, wanted)
    np.testing.assert_array_equal(held[6:], wanted[6:])
    left_deg, _ = turned_deg(held - MID)
    np.testing.assert_allclose(left_deg[:2], 0.0, atol=0.01)
    # The nearest such command: what was taken away is what turns the line of sight.
    np.testing.assert_allclose(left_deg[2], (LEFT @ (held - MID)[:6])[2], atol=1e-9)
    away = (wanted - held)[:6]
    assert np.linalg.matrix_rank(np.vstack([LEFT[:2], away]), tol=1e-2) == 2


@pytest.mark.parametrize(("n", "seen"), [(10, True), (400, False)])
def test_without_enough_movements_seen_eyes_make_no_saccades(n: int, seen: bool) -> None:
    control = learned(n, seen=seen)
    np.testing.assert_array_equal(control.saccade(MID, np.array([6.0, -3.0]), None), MID)
    np.testing.assert_array_equal(control.held(MID, MID + 0.01), MID + 0.01)


def test_only_what_a_saccade_led_to_is_learned_from() -> None:
    control = GazeControl(LOWEST, HIGHEST, 0.002)
    control.learn(MID, turned_deg(MID))
    control.saccade(MID, np.zeros(2), None)
    control.forget_movement()
    control.learn(MID, turned_deg(MID))
    assert not control.state()["left_eye_squares"].any()


def test_an_eye_that_was_not_seen_clearly_learns_nothing() -> None:
    control = GazeControl(LOWEST, HIGHEST, 0.002)
    after = control.saccade(MID, np.zeros(2), np.random.default_rng(3))
    turns_deg = turned_deg(after - MID)
    turns_deg[1] = np.nan
    control.learn(after, turns_deg)
    state = control.state()
    assert (state["left_eye_n_movements"], state["right_eye_n_movements"]) == (1, 0)


def test_commands_stay_within_their_limits() -> None:
    command = learned().saccade(MID, np.array([60.0, 0.0]), None)
    assert (command >= LOWEST).all()
    assert (command <= HIGHEST).all()
    assert (learned().held(MID, np.full(12, 0.5)) <= HIGHEST).all()


def test_goes_on_from_its_state_bit_for_bit() -> None:
    whole, part = learned(), GazeControl(LOWEST, HIGHEST, 0.002)
    part.restore(learned().state())
    target_deg = np.array([4.0, 2.0])
    assert whole.saccade(MID, target_deg, None).tobytes() == (
        part.saccade(MID, target_deg, None).tobytes()
    )


@pytest.mark.parametrize(
    ("target", "turns", "message"),
    [
        (np.zeros(3), np.zeros((2, 3)), r"got shapes \(3,\) and \(2, 3\)"),
        (np.zeros(2), np.zeros((3, 2)), r"got shapes \(2,\) and \(3, 2\)"),
        (np.array([np.inf, 0.0]), np.zeros((2, 3)), "finite numbers, or NaN"),
    ],
)
def test_refuses_what_is_no_gaze(target, turns, message: str) -> None:
    with pytest.raises(InputError, match=message):
        checked_gaze(target, turns)
