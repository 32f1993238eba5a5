"""The contract of all learning rules, of those that turn the eyes, too."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from lockstep import InputError, build
from tests.vergence_rl.probe import SETTINGS, gaze_errors, trained_on_gazes
from tests.vergence_rl.small_agents import (
    CACLA,
    GAZE,
    HINDSIGHT,
    MEAN,
    assert_same_state,
    changed,
    experience,
    knowing,
    observation,
    train,
    trained,
)
from vergence_rl import Agent, VergenceRlConfig

CASES = {"cacla": CACLA, "hindsight": HINDSIGHT, "mean of best": MEAN, "gaze": GAZE}
# In the probe's episodes of 10 iterations.
PROBE: dict[str, dict[str, Any]] = {
    "cacla": {
        "cacla.n_hidden": 8,
        "cacla.hidden_initial_width": 0.5,
        "cacla.exploration_variance": 1e-4,
        "cacla.critic_learning_rate": 0.2,
        "cacla.discount": 0.0,
    },
    "hindsight": {},
    "mean of best": {"hindsight.n_best": 3},
}


@pytest.fixture(params=CASES)
def config(request: pytest.FixtureRequest) -> VergenceRlConfig:
    return CASES[request.param]


@pytest.mark.parametrize("case", PROBE)
def test_it_learns_the_probe(case: str) -> None:
    rule = {"learning_rule": CASES[case].learning_rule} | PROBE[case]
    agent = Agent(build(VergenceRlConfig, SETTINGS | rule))
    assert gaze_errors(agent)[0].max() > 0.05
    trained_on_gazes(agent, 1500 if rule["learning_rule"] == "cacla" else 600)
    assert gaze_errors(agent)[0].max() < 0.005


def test_what_goes_on_from_a_state_is_undisturbed_bit_for_bit(config: VergenceRlConfig) -> None:
    # Sums of regressions hold episodes that the actor has not been solved for.
    (agent, now), other = knowing(config), trained(config, 25)
    train(agent, now, 20)
    other.restore(agent.state())
    ours, theirs = (train(one, now + 20, 100, energy_penalty=0.3) for one in (agent, other))
    for one, two in zip(ours, theirs, strict=True):
        assert one.command.tobytes() == two.command.tobytes()
        np.testing.assert_array_equal(one.td_error, two.td_error)
    assert_same_state(other.state(), agent.state())


def test_a_restored_agent_has_no_last_action_to_learn_from(config: VergenceRlConfig) -> None:
    agent, now = knowing(config)
    train(agent, now, 4)
    agent.restore(agent.state())
    n_steps = agent.learning_steps
    assert math.isnan(train(agent, now + 4, 1)[0].td_error)
    assert agent.learning_steps == n_steps


def test_a_state_shares_no_memory_with_the_agent(config: VergenceRlConfig) -> None:
    agent, _ = knowing(config)
    state = agent.state()
    kept = {name: array.copy() for name, array in state.items()}
    agent.restore(state)
    for array in state.values():
        array[...] = 7
    assert_same_state(agent.state(), kept)


def _damaged(state: dict[str, NDArray[Any]]) -> Iterator[tuple[dict[str, Any], str]]:
    """Yield states that cannot be, and what is said of each."""
    for name, array in state.items():
        yield {n: a for n, a in state.items() if n != name}, "state: expected"
        yield state | {name: np.repeat(array, 2)}, f"{name}: expected .* of shape"
        yield state | {name: array.astype(np.float32)}, f"{name}: expected (float|int)64"
        if array.dtype.kind == "f":
            yield state | {name: array * np.nan}, f"{name}: expected finite numbers"
        else:
            yield state | {name: np.array(-5)}, f"{name}: expected 0 or more, got -5"
    for name in {"td_variance", "sum_weight"} & set(state):
        yield state | {name: np.array(0.0)}, f"{name}: expected more than 0"
    spread = -np.ones_like(state["statistics_squared_deviation"])
    yield state | {"statistics_squared_deviation": spread}, "deviation: expected 0 or more, got -1"
    yield state | {"colour": np.array(1)}, "state: expected"


def test_a_bad_state_is_refused_and_changes_nothing(config: VergenceRlConfig) -> None:
    agent, _ = knowing(config)
    before = agent.state()
    for state, message in _damaged(agent.state()):
        with pytest.raises(InputError, match=message):
            agent.restore(state)
    assert_same_state(agent.state(), before)


def test_a_test_episode_changes_nothing_and_has_no_noise(config: VergenceRlConfig) -> None:
    agent, now = knowing(config)
    before = agent.state()
    shown = [
        observation(config, now + i, learning=False, exploration=False, training_iteration=now)
        for i in range(5)
    ]
    first, second = ([agent.observe(**seen) for seen in shown] for _ in range(2))
    for one, two in zip(first, second, strict=True):
        assert one.action.tobytes() == two.action.tobytes()
        assert math.isnan(one.td_error)
    assert_same_state(agent.state(), before)


def test_noise_is_a_function_of_seed_and_training_iteration(config: VergenceRlConfig) -> None:
    def first_action(seed: int, now: int) -> bytes:
        agent, start = knowing(config, seed=seed)
        seen = observation(config, start, learning=False, training_iteration=now)
        return agent.observe(**seen).action.tobytes()

    assert first_action(1, 5) == first_action(1, 5)
    assert len({first_action(1, 5), first_action(1, 6), first_action(2, 5)}) == 3


def test_commands_stay_within_their_limits(config: VergenceRlConfig) -> None:
    agent, now = knowing(config)
    lowest, highest = config.task.lowest, config.task.highest
    if np.isinf(lowest).any():
        lowest, highest = np.zeros(12), np.full(12, 0.2)
    commands = np.array([decision.command for decision in train(agent, now, 200)])
    assert (commands >= lowest).all()
    assert (commands <= highest).all()


@pytest.mark.parametrize(("iteration", "now"), [(5, 5), (4, 14), (5, 4), (3, 3), (0, 4)])
def test_nothing_is_learned_after_a_gap(config, iteration: int, now: int) -> None:
    agent, start = knowing(config)
    train(agent, start, 4)
    n_steps = agent.learning_steps
    seen = observation(config, start + 7, iteration=iteration, training_iteration=start + now)
    assert math.isnan(agent.observe(**seen).td_error)
    assert agent.learning_steps == n_steps
    assert agent.observe(**observation(config, start + now + 1, iteration=iteration + 1))
    assert agent.learning_steps == n_steps + 1


def test_nothing_is_learned_from_an_action_taken_without_learning(config) -> None:
    agent, now = knowing(config)
    train(agent, now, 3)
    n_steps = agent.learning_steps
    agent.observe(**observation(config, now + 3, learning=False, exploration=False))
    assert math.isnan(train(agent, now + 4, 1)[0].td_error)
    assert agent.learning_steps == n_steps


def test_learning_steps_are_iterations_but_the_first_of_an_episode(config) -> None:
    agent, now = knowing(config)
    length = config.iterations_per_episode
    assert agent.learning_steps == now - now // length


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"features": np.ones((2, 4))}, r"features: expected 6, got shape \(2, 4\)"),
        ({"features": np.full(6, np.nan)}, "features and activations: expected finite"),
        ({"activations": np.ones(3)}, r"activations: expected .*rectus.*, got .*\(3,\)"),
        ({"reward": math.nan}, "reward: expected a finite number, got nan"),
        ({"energy_penalty": math.inf}, "energy_penalty: expected a finite number, got inf"),
        ({"iteration": -1}, "iteration: expected 0 or more, got -1"),
        ({"training_iteration": -1}, "training_iteration: expected 0 or more, got -1"),
        ({"target_deg": np.zeros(3)}, r"got shapes \(3,\) and \(2, 3\)"),
        ({"turns_deg": np.zeros((3, 2))}, r"got shapes \(2,\) and \(3, 2\)"),
        ({"target_deg": np.array([np.inf, 0.0])}, "finite numbers, or NaN"),
        ({"leading_eye": 2.0}, "leading_eye: expected 0, the left one, or 1, got 2.0"),
    ],
)
def test_a_bad_observation_is_refused_and_changes_nothing(config, changes, message) -> None:
    (agent, now), (other, _) = knowing(config), knowing(config)
    for one in (agent, other):
        train(one, now, 3)
    with pytest.raises(InputError, match=message):
        agent.observe(**observation(config, now + 3, **changes))
    ours, theirs = (train(one, now + 3, 1)[0] for one in (agent, other))
    np.testing.assert_array_equal(ours.td_error, theirs.td_error)
    assert ours.command.tobytes() == theirs.command.tobytes()
    assert_same_state(agent.state(), other.state())


@pytest.mark.parametrize(
    ("entries", "known"),
    [("all", slice(0, 8)), ("features", slice(0, 6)), ("activations", slice(6, 8))],
)
@pytest.mark.parametrize("rule", [CACLA, HINDSIGHT], ids=["cacla", "hindsight"])
def test_what_is_hidden_from_a_rule_changes_nothing(rule, entries: str, known: slice) -> None:
    agent = trained(changed(rule, {"state_entries": entries}), 30)

    def action(values: NDArray[np.float64]) -> bytes:
        features, activations = values[:6].reshape(2, 3).astype(np.float32), values[6:]
        seen = observation(rule, 30, features=features, activations=activations)
        calm = {"learning": False, "exploration": False, "iteration": 0}
        return agent.observe(**(seen | calm)).action.tobytes()

    features, activations, _ = experience(30)
    both = np.concatenate([features.ravel().astype(np.float64), activations])
    differs = [action(both + 0.05 * np.eye(8)[i]) != action(both) for i in range(8)]
    assert differs == [i in range(8)[known] for i in range(8)]
