"""Eyes that are turned by what is felt alone while one of them sees nothing."""

from collections.abc import Callable

import numpy as np
import pytest

from tests.vergence_rl.small_agents import assert_same_state
from vergence_rl import Decision
from vergence_rl.hindsight.config import HindsightConfig
from vergence_rl.hindsight.covered import CoveredRule
from vergence_rl.hindsight.rule import HindsightRule
from vergence_rl.learning_rule import LearningRule, Task, TimeStep

N, N_FEATURES = 10, 3
CONFIG = HindsightConfig(regression_period=2 * N, least_memory=1000.0)
# Felt are one muscle of the eyes, and the lens.
TASK = Task(
    seed=1,
    n_state=N_FEATURES + 2 + 1,
    n_felt=2,
    lowest=np.zeros(1),
    highest=np.full(1, 0.3),
    n_training_iterations=100_000,
    iterations_per_episode=N,
    initial_td_variance=1.0,
    td_variance_rate=0.001,
)
Features = Callable[[float, float], list[float]]


def _seen(i: int, now: int, place: float, lens: float, says: Features) -> TimeStep:
    """Return what is felt of a place, and what features say; the lens tells which place is best.

    Standardised as the agent does it.
    """
    wanted = _wanted(lens)
    felt = (place - 0.15) / 0.05, (lens - 0.2) / 0.1
    state = np.array([*says(place, wanted), *felt, 1.0])
    return TimeStep(i, now, state, np.array([place]), -abs(place - wanted))


def _wanted(lens: float) -> float:
    return 0.05 + 0.5 * lens


def _train(rule: LearningRule, n_episodes: int, says: Features, first: int = 0) -> list[Decision]:
    """Train with lenses that have focused; return all decisions."""
    draw, decisions = np.random.default_rng(first), []
    for k in range(first, first + n_episodes):
        lens, place = draw.uniform(0.1, 0.3), draw.uniform(0.0, 0.3)
        for i in range(N):
            seen = _seen(i, k * N + i, place, lens, says)
            decisions.append(rule.step(seen, learning=True, draw=draw))
            place = float(decisions[-1].command[0])
    return decisions


def _disparity(place: float, wanted: float) -> list[float]:
    return [20.0 * (wanted - place), 1.0, 0.0]


def _what_an_image_says(place: float, wanted: float) -> list[float]:
    return [-3.0, 1.0, 2.0]


def _settled(rule: LearningRule, lens: float, *, covered: bool) -> float:
    place = 0.15
    for i in range(20):
        seen = _seen(i, 0, place, lens, _what_an_image_says)
        if covered:
            seen = TimeStep(*(i, 0, seen.state, seen.activations, 0.0), is_binocular=False)
        place = float(rule.step(seen, learning=False, draw=None).command[0])
    return place


def test_a_covered_eye_follows_the_lens_and_not_its_features() -> None:
    rule = CoveredRule(HindsightRule(CONFIG, TASK), TASK)
    _train(rule, 200, _disparity)
    for lens in (0.12, 0.2, 0.28):
        assert _settled(rule, lens, covered=True) == pytest.approx(_wanted(lens), abs=0.01)
        # With both eyes the features count, which ask for less convergence.
        assert _settled(rule, lens, covered=False) < 0.03


def test_with_both_eyes_nothing_is_different_from_the_rule_behind() -> None:
    alone, behind = HindsightRule(CONFIG, TASK), HindsightRule(CONFIG, TASK)
    rule = CoveredRule(behind, TASK)
    expected = _train(alone, 30, _disparity)
    found = _train(rule, 30, _disparity)
    for ours, theirs in zip(found, expected, strict=True):
        np.testing.assert_array_equal(ours.command, theirs.command)
    assert_same_state(behind.state(), alone.state())
    assert set(rule.state()) == set(alone.state()) | {f"felt_{n}" for n in alone.state()}


def test_an_eye_that_is_covered_in_training_tries_what_is_better() -> None:
    rule, draw = CoveredRule(HindsightRule(CONFIG, TASK), TASK), np.random.default_rng(1)
    seen = TimeStep(0, 0, np.zeros(TASK.n_state), np.full(1, 0.15), 0.0, is_binocular=False)
    commands = {float(rule.step(seen, learning=True, draw=draw).command[0]) for _ in range(5)}
    assert len(commands) == 5


def test_what_was_felt_is_restored() -> None:
    rule, other = (CoveredRule(HindsightRule(CONFIG, TASK), TASK) for _ in range(2))
    _train(rule, 20, _disparity)
    other.restore(rule.state())
    assert_same_state(other.state(), rule.state())
    assert _settled(other, 0.28, covered=True) == _settled(rule, 0.28, covered=True)
    for each in (rule, other):
        _train(each, 10, _disparity, first=20)
    assert_same_state(other.state(), rule.state())
