import numpy as np
import pytest

from vergence_rl import TimeStep
from vergence_rl.gaze.config import GazeConfig
from vergence_rl.gaze.control import GazeControl

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


def new(*, holds_gaze: bool = True, equal_innervation: bool = False) -> GazeControl:
    config = GazeConfig(saccade_noise=0.002, equal_innervation=equal_innervation)
    return GazeControl(LOWEST, HIGHEST, config, holds_gaze=holds_gaze)


def turned_deg(change: np.ndarray, right_strength: float = 1.0) -> np.ndarray:
    return np.array([LEFT @ change[:6], right_strength * RIGHT @ change[6:]])


def see(
    control: GazeControl, activations: np.ndarray, turns_deg: np.ndarray, *, iteration: int = 1
) -> None:
    observation = TimeStep(iteration, iteration, np.zeros(0), activations, 0.0, turns_deg=turns_deg)
    control.see(observation, learning=True)


def learned(
    n: int = 400,
    *,
    seen: bool = True,
    price: float = 0.0,
    right_strength: float = 1.0,
    **settings: bool,
) -> GazeControl:
    """Eyes that turn in proportion to the change, having made n saccades of noise.

    price: of each unit of activation; right_strength: of the right eye's muscles.
    """
    draw = np.random.default_rng(1)
    control = new(**settings)
    for _ in range(n):
        before = draw.uniform(0.08, 0.12, 12)
        after = control.saccade(before, np.zeros(2), draw)
        turns_deg = turned_deg(after - before, right_strength) if seen else np.full((2, 3), np.nan)
        observation = TimeStep(
            *(1, 1, np.zeros(0), after, 0.0),
            turns_deg=turns_deg,
            energy_penalty=price * float(after.sum()),
        )
        control.see(observation, learning=True)
    return control


def test_saccades_turn_both_eyes_alike_without_rotating_them() -> None:
    command = learned().saccade(MID, np.array([6.0, -3.0]), None)
    expected = [[6.0, -3.0, 0.0], [6.0, -3.0, 0.0]]
    np.testing.assert_allclose(turned_deg(command - MID), expected, atol=0.02)


@pytest.mark.parametrize("equal_innervation", [False, True])
def test_with_equal_innervation_a_weak_eye_turns_less(equal_innervation: bool) -> None:
    control = learned(right_strength=0.5, equal_innervation=equal_innervation)
    left, right = control.saccade(MID, np.array([6.0, -3.0]), None).reshape(2, 6)
    mirrored, _ = control.saccade(MID, np.array([-6.0, -3.0]), None).reshape(2, 6)
    assert (right.tolist() == mirrored.tolist()) == equal_innervation
    turned = turned_deg(np.append(left, right) - MID, 0.5)
    assert turned[1, 0] / turned[0, 0] == pytest.approx(0.5 if equal_innervation else 1.0, abs=0.05)


def test_with_equal_innervation_healthy_eyes_save_as_much_energy() -> None:
    free, equal = (
        learned(2500, price=1.0, equal_innervation=equal_innervation)
        for equal_innervation in (False, True)
    )
    of_free = of_equal = MID
    for _ in range(5):
        of_free = free.verge(of_free, np.zeros(3), leads=1)
        of_equal = equal.verge(of_equal, np.zeros(3), leads=1)
    np.testing.assert_allclose(of_equal, of_free, atol=1e-3)


def test_with_equal_innervation_both_eyes_know_the_same() -> None:
    control, other = learned(equal_innervation=True), new(equal_innervation=True)
    assert control.state()["eyes_n_movements"] == 2 * 400
    other.restore(control.state())
    target_deg = np.array([6.0, -3.0])
    commands = [each.saccade(MID, target_deg, None) for each in (control, other)]
    np.testing.assert_array_equal(commands[0], commands[1])


TURN = np.array([1.5, -0.5, 0.8])
# The left line of sight stays; about it each eye turns by half.
VERGED = [[0.0, 0.0, -0.4], [1.5, -0.5, 0.4]]


def test_vergence_turns_the_right_eye_and_both_about_their_lines_of_sight() -> None:
    command = learned().verge(MID, TURN)
    np.testing.assert_allclose(turned_deg(command - MID), VERGED, atol=0.02)


def test_where_the_right_eye_leads_the_left_one_turns_the_other_way() -> None:
    command = learned().verge(MID, TURN, leads=1)
    expected = [[-1.5, 0.5, -0.4], [0.0, 0.0, 0.4]]
    np.testing.assert_allclose(turned_deg(command - MID), expected, atol=0.02)


def test_energy_is_saved_where_the_eye_that_leads_looks() -> None:
    control, command = learned(2500, price=1.0), MID
    for _ in range(5):
        command = control.verge(command, np.zeros(3), leads=1)
    assert command.sum() < MID.sum() - 0.1
    np.testing.assert_allclose(turned_deg(command - MID)[:, :2], 0.0, atol=0.05)


def test_with_a_price_vergence_relaxes_muscles_that_pull_against_each_other() -> None:
    control = learned(2500, price=1.0)
    command = control.verge(MID, TURN)
    turned = turned_deg(command - MID)
    np.testing.assert_allclose(turned[:, :2], np.array(VERGED)[:, :2], atol=0.03)
    # Both eyes may rotate alike.
    assert turned[1, 2] - turned[0, 2] == pytest.approx(0.8, abs=0.03)
    assert command.sum() < MID.sum() - 0.1
    for _ in range(20):
        command = control.verge(command, np.zeros(3))
    silent = (command < 1e-6).reshape(2, 3, 2)
    assert silent.any(axis=2).all(), "one of each pair of antagonists"


def test_how_high_the_price_is_does_not_matter() -> None:
    # Four times as much, so that nothing is rounded otherwise.
    cheap, dear = learned(2500, price=1.0), learned(2500, price=4.0)
    assert cheap.verge(MID, TURN).tobytes() == dear.verge(MID, TURN).tobytes()


def test_without_saccades_each_eye_makes_half_of_the_vergence() -> None:
    command = learned(holds_gaze=False).verge(MID, TURN)
    np.testing.assert_allclose(turned_deg(command - MID), [-0.5 * TURN, 0.5 * TURN], atol=0.02)


def test_without_saccades_both_eyes_may_turn_alike_to_save_energy() -> None:
    control, held = (learned(2500, price=1.0, holds_gaze=holds) for holds in (False, True))
    command, at_gaze = control.verge(MID, TURN), held.verge(MID, TURN)
    left_deg, right_deg = turned_deg(command - MID)
    np.testing.assert_allclose(right_deg - left_deg, TURN, atol=0.03)
    for _ in range(20):
        command, at_gaze = (
            control.verge(command, np.zeros(3)),
            held.verge(at_gaze, np.zeros(3)),
        )
    assert command.sum() < at_gaze.sum()


@pytest.mark.parametrize(("n", "seen"), [(10, True), (400, False)])
def test_without_enough_movements_seen_eyes_make_no_saccades(n: int, seen: bool) -> None:
    control = learned(n, seen=seen)
    np.testing.assert_array_equal(control.saccade(MID, np.array([6.0, -3.0]), None), MID)
    np.testing.assert_array_equal(control.verge(MID, TURN), MID)


def test_only_what_a_saccade_led_to_is_learned_from() -> None:
    control = new()
    see(control, MID, turned_deg(MID))
    control.saccade(MID, np.zeros(2), None)
    # An episode begins.
    see(control, MID, turned_deg(MID), iteration=0)
    see(control, MID, turned_deg(MID))
    assert control.state()["left_eye_n_movements"] == 0


def test_an_eye_that_was_not_seen_clearly_learns_nothing() -> None:
    control = new()
    after = control.saccade(MID, np.zeros(2), np.random.default_rng(3))
    turns_deg = turned_deg(after - MID)
    turns_deg[1] = np.nan
    see(control, after, turns_deg)
    state = control.state()
    assert (state["left_eye_n_movements"], state["right_eye_n_movements"]) == (1, 0)


def test_commands_stay_within_their_limits() -> None:
    command = learned().saccade(MID, np.array([60.0, 0.0]), None)
    assert (command >= LOWEST).all()
    assert (command <= HIGHEST).all()
    assert (learned().verge(MID, 40.0 * TURN) <= HIGHEST).all()
