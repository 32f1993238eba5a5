"""An agent that makes saccades: what its rule sees of them."""

import math

import numpy as np
import pytest

from lockstep.configuration import build
from lockstep.errors import InputError
from tests.vergence_rl.small_agents import assert_same_state, changed
from vergence_rl.agent import Agent
from vergence_rl.config import VergenceRlConfig
from vergence_rl.learning_rule import Decision

GAZE = build(
    VergenceRlConfig,
    {
        "n_bases": 3,
        "n_training_iterations": 300,
        "learning_rule": "hindsight",
        "command_space": "all_muscles",
        "lowest_activations": (0.0,),
        "highest_activations": (0.2,),
        "products_of_activations": True,
        "fixation_iterations": 5,
        "hindsight.regression_period": 10,
    },
)


def _fixated(
    agent: Agent, n_episodes: int, first: int = 0, *, is_seen: bool = True, penalty: float = 0.0
) -> list[Decision]:
    """Return the decisions of episodes of two fixations, each with two saccades.

    is_seen: whether the first saccade's movement is; without it there is no second one. penalty: in
    each reward.
    """
    draw, decisions = np.random.default_rng(4), []
    for i in range(first * 10, (first + n_episodes) * 10):
        of_fixation = i % 5
        decisions.append(
            agent.observe(
                draw.random(6),
                draw.uniform(0.05, 0.15, 12),
                -float(draw.random()) - penalty,
                i % 10,
                i,
                learning=True,
                exploration=True,
                target_deg=np.array([1.0, 2.0]) * (1.0 if of_fixation < 1 + is_seen else np.nan),
                turns_deg=draw.normal(0, 1, (2, 3))
                * (1.0 if is_seen and of_fixation == 1 else np.nan),
                energy_penalty=penalty,
            )
        )
    return decisions


@pytest.fixture(scope="module")
def known() -> dict[str, np.ndarray]:
    """The state of an agent that knows how its eyes turn, and has learned little else."""
    agent = Agent(GAZE)
    _fixated(agent, 170)
    return agent.state()


def _knowing(known: dict[str, np.ndarray], **changes: int) -> Agent:
    agent = Agent(changed(GAZE, changes))
    agent.restore({name: known.get(name, value) for name, value in agent.state().items()})
    return agent


def test_a_rule_learns_from_what_follows_the_saccades_alone(known) -> None:
    agent = _knowing(known)
    n_movements, n_steps = agent.state()["left_eye_n_movements"], agent.learning_steps
    decisions = _fixated(agent, 2, 170)
    # A saccade reports no TD error, and neither does the first iteration of vergence.
    undefined = [math.isnan(d.td_error) for d in decisions]
    assert undefined == [True, True, True, False, False] * 4
    assert agent.state()["left_eye_n_movements"] == n_movements + 4
    assert agent.state()["sum_weight"] != known["sum_weight"]
    # As for all eyes: one step for each iteration but the first of an episode.
    assert agent.learning_steps == n_steps + 18


def test_until_movements_are_known_nothing_is_learned_of_vergence_and_the_eyes_stay() -> None:
    agent = Agent(GAZE)
    decisions = _fixated(agent, 2)
    assert all(math.isnan(d.td_error) for d in decisions)
    assert not agent.state()["actor"].any()
    moved = [np.abs(d.action).max() > 0.0 for d in decisions]
    # The first saccade is noise, and the second would correct what is not known.
    assert moved == [True, False, False, False, False] * 4
    assert agent.learning_steps == 18


@pytest.mark.parametrize(
    ("gaze", "message"),
    [
        ({"target_deg": np.zeros(3)}, r"got shapes \(3,\) and \(2, 3\)"),
        ({"turns_deg": np.zeros((3, 2))}, r"got shapes \(2,\) and \(3, 2\)"),
        ({"target_deg": np.array([np.inf, 0.0])}, "finite numbers, or NaN"),
    ],
)
def test_what_is_no_gaze_is_refused_and_changes_nothing(gaze, message: str) -> None:
    agent = Agent(GAZE)
    _fixated(agent, 2)
    before = agent.state()
    with pytest.raises(InputError, match=message):
        agent.observe(
            np.ones(6), np.full(12, 0.1), -0.2, 0, 20, learning=True, exploration=True, **gaze
        )
    assert_same_state(agent.state(), before)


def test_products_of_activations_are_of_one_eye() -> None:
    assert GAZE.n_felt == 12 + 2 * 21
    agent = Agent(GAZE)
    _fixated(agent, 1)
    means = agent.state()["statistics_mean"]
    assert len(means) == 6 + 2 * 21 + 12
    assert 0.005 < means[6:48].min() < means[6:48].max() < 0.02


def test_gaze_goes_on_from_its_state_bit_for_bit(known) -> None:
    whole, part = _knowing(known), _knowing(known)
    _fixated(whole, 3, 170, penalty=0.5)
    part.restore(whole.state())
    again = (_fixated(agent, 20, 173, penalty=0.5) for agent in (whole, part))
    for one, other in zip(*again, strict=True):
        assert one.command.tobytes() == other.command.tobytes()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"fixation_iterations": 3},
            "fixation_iterations: expected 0, or 4 or more, of ",
        ),
        ({"iterations_per_episode": 12}, "iterations_per_episode: expected a multiple of 5"),
        (
            {"learning_rule": "cacla"},
            "learning_rule: expected another one than cacla",
        ),
        ({"measures_turns": True}, "measures_turns: expected false with saccades"),
        ({"hindsight.n_best": 3}, "hindsight.n_best: expected less than 3"),
        (
            {"command_space": "pair", "products_of_activations": False},
            "fixation_iterations: expected 0 with command_space pair",
        ),
    ],
)
def test_fixations_that_do_not_fit_are_refused(changes, message: str) -> None:
    with pytest.raises(InputError, match=f"^{message}"):
        changed(GAZE, changes)


def test_a_state_of_fewer_movements_than_none_is_refused(known) -> None:
    with pytest.raises(InputError, match="left_eye_n_movements: expected 0 or more, got -5"):
        Agent(GAZE).restore(known | {"left_eye_n_movements": np.array(-5)})


def test_vergence_is_learned_after_a_saccade_that_was_not_seen(known) -> None:
    agent = _knowing(known)
    decisions = _fixated(agent, 4, 170, is_seen=False)
    assert [math.isnan(d.td_error) for d in decisions] == [True, True, True, False, False] * 8
    state = agent.state()
    assert state["left_eye_n_movements"] == known["left_eye_n_movements"]
    assert (state["actor"] != known["actor"]).any()


def test_the_penalty_is_learned_and_hidden_from_the_rule(known) -> None:
    """The rule's best places are those of most reward without it."""
    bare, priced = _knowing(known), _knowing(known)
    for one, other in zip(
        _fixated(bare, 2, 170), _fixated(priced, 2, 170, penalty=0.5), strict=True
    ):
        assert one.td_error == pytest.approx(other.td_error, nan_ok=True)
    np.testing.assert_allclose(bare.state()["actor"], priced.state()["actor"])
    assert (bare.state()["effort_products"] != priced.state()["effort_products"]).any()


@pytest.mark.parametrize("n_best", [1, 2])
def test_as_many_best_places_as_a_fixation_has(known, n_best: int) -> None:
    agent = _knowing(known, **{"hindsight.n_best": n_best})
    _fixated(agent, 4, 170)
    assert (agent.state()["actor"] != known["actor"]).any()


def _verged(agent: Agent, n_episodes: int) -> list[Decision]:
    """Return the decisions of episodes without saccades, of which two movements are seen."""
    draw = np.random.default_rng(5)
    return [
        agent.observe(
            draw.random(6),
            draw.uniform(0.05, 0.15, 12),
            -float(draw.random()),
            i % 10,
            i,
            learning=True,
            exploration=True,
            turns_deg=draw.normal(0, 1, (2, 3)) * (1.0 if i % 10 in {1, 6} else np.nan),
        )
        for i in range(n_episodes * 10)
    ]


def test_without_saccades_vergence_is_learned_from_what_follows_the_first_command() -> None:
    changes = {"fixation_iterations": 0, "measures_turns": True}
    agent = Agent(changed(GAZE, changes))
    # The eyes are shaken until it is known how they turn: 336 movements, two of an episode.
    decisions = _verged(agent, 168)
    assert all(math.isnan(d.td_error) for d in decisions[:-4])
    assert all(np.abs(d.action).max() > 0.0 for d in decisions)
    decisions = _verged(agent, 2)
    assert [math.isnan(d.td_error) for d in decisions] == ([True] * 2 + [False] * 8) * 2
    assert agent.state()["actor"].any()
