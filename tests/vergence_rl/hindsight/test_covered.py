"""Eyes that are turned by what is felt alone while one of them sees nothing."""

import dataclasses
from collections.abc import Callable

import numpy as np
import pytest

from tests.vergence_rl.small_agents import assert_same_state
from vergence_rl import Decision
from vergence_rl.hindsight.config import HindsightConfig
from vergence_rl.hindsight.covered import CoveredRule
from vergence_rl.hindsight.rule import HindsightRule
from vergence_rl.learning_rule import LearningRule, Task, TimeStep

N, N_FEATURES, N_FOCUSING = 10, 3, 3
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


def _seen(now: int, place: float, lens: float, wanted: float, says: Features) -> TimeStep:
    """Return what is felt, standardised, and what features say; the reward is for `wanted`."""
    felt = (place - 0.15) / 0.05, (lens - 0.2) / 0.1
    state = np.array([*says(place, wanted), *felt, 1.0])
    return TimeStep(now % N, now, state, np.array([place]), -abs(place - wanted))


def _wanted(lens: float) -> float:
    return 0.05 + 0.5 * lens


def _train(rule: LearningRule, n_episodes: int, says: Features, first: int = 0) -> list[Decision]:
    """Train with lenses that focus in the first iterations; return all decisions."""
    draw, decisions = np.random.default_rng(first), []
    for k in range(first, first + n_episodes):
        lens, place = draw.uniform(0.1, 0.3), draw.uniform(0.0, 0.3)
        for i in range(N):
            felt_lens = lens if i >= N_FOCUSING else draw.uniform(0.1, 0.3)
            seen = _seen(k * N + i, place, felt_lens, _wanted(lens), says)
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
        seen = _seen(i, place, lens, _wanted(lens), _what_an_image_says)
        seen = dataclasses.replace(seen, is_binocular=not covered)
        place = float(rule.step(seen, learning=False, draw=None).command[0])
    return place


def test_a_covered_eye_follows_the_lens_and_not_its_features() -> None:
    rule = CoveredRule(HindsightRule(CONFIG, TASK), TASK, N_FOCUSING)
    _train(rule, 200, _disparity)
    for lens in (0.12, 0.2, 0.28):
        assert _settled(rule, lens, covered=True) == pytest.approx(_wanted(lens), abs=0.003)
        # With both eyes the features count, which ask for less convergence.
        assert _settled(rule, lens, covered=False) < 0.03


def test_with_both_eyes_nothing_is_different_from_the_rule_behind() -> None:
    alone, behind = HindsightRule(CONFIG, TASK), HindsightRule(CONFIG, TASK)
    rule = CoveredRule(behind, TASK, N_FOCUSING)
    expected = _train(alone, 30, _disparity)
    found = _train(rule, 30, _disparity)
    for ours, theirs in zip(found, expected, strict=True):
        np.testing.assert_array_equal(ours.command, theirs.command)
    assert_same_state(behind.state(), alone.state())
    assert set(rule.state()) == set(alone.state()) | {f"felt_{n}" for n in alone.state()}


def test_an_eye_that_is_covered_in_training_tries_what_is_better() -> None:
    rule = CoveredRule(HindsightRule(CONFIG, TASK), TASK, N_FOCUSING)
    draw = np.random.default_rng(1)
    seen = TimeStep(0, 0, np.zeros(TASK.n_state), np.full(1, 0.15), 0.0, is_binocular=False)
    commands = {float(rule.step(seen, learning=True, draw=draw).command[0]) for _ in range(5)}
    assert len(commands) == 5


def test_what_was_felt_is_restored() -> None:
    rule, other = (CoveredRule(HindsightRule(CONFIG, TASK), TASK, N_FOCUSING) for _ in range(2))
    _train(rule, 20, _disparity)
    other.restore(rule.state())
    assert_same_state(other.state(), rule.state())
    assert _settled(other, 0.28, covered=True) == _settled(rule, 0.28, covered=True)
    for each in (rule, other):
        _train(each, 10, _disparity, first=20)
    assert_same_state(other.state(), rule.state())
