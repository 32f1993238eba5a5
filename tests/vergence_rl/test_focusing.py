"""Lenses beside what turns the eyes: whose turn it is, what stays, and what is learned."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from lockstep import InputError
from lockstep.scales import ScalesConfig
from tests.vergence_rl.small_agents import assert_same_state
from vergence_rl import Agent, Decision, VergenceRlConfig
from vergence_rl.focusing import LensConfig
from vergence_rl.hindsight.config import HindsightConfig

N_FEATURES, N = 6, 8
HELD = 2 * N
HIGHEST = np.array([0.2, 0.1, 0.4, 0.4])
TWELVE = VergenceRlConfig(
    command_space="all_muscles_and_lenses",
    lowest_activations=(0.0,),
    highest_activations=(0.2,),
    learning_rule="hindsight",
    iterations_per_episode=20,
    scales=ScalesConfig(n_for_lenses=1),
)


def _config(space: str = "pair_and_lenses", **changes: object) -> VergenceRlConfig:
    """Of the eight iterations of an episode four are the eyes', two or four each lens's."""
    n = 4 if space == "pair_and_lenses" else 3
    settings = {
        "learning_rule": "hindsight",
        "command_space": space,
        "lowest_activations": (0.0,),
        "highest_activations": tuple(HIGHEST[:n].tolist()),
        "iterations_per_episode": N,
        "n_training_iterations": 300 * N,
        "n_bases": N_FEATURES // 2,
        "hindsight": HindsightConfig(regression_period=2 * N, least_memory=60.0),
        "scales": ScalesConfig(n_for_lenses=1),
        "lens": LensConfig(looking_iterations=HELD),
    }
    return VergenceRlConfig(**(settings | changes))  # type: ignore[arg-type]


# Ten iterations are the eyes', of which the first three are not compared.
LONG = _config(
    "pair_and_lens",
    n_training_iterations=200 * 20,
    iterations_per_episode=20,
    hindsight=HindsightConfig(regression_period=40, least_memory=60.0),
)


def _long_episode(agent: Agent, first: int, *, training: bool = True) -> list[np.ndarray]:
    """Reward the eyes at 0.12, but most where they are while a lens focuses; lenses at 0.2."""
    places = [np.array([0.08, 0.05, 0.1])]
    for i in range(20):
        medial, _, lens = places[-1]
        reward = -abs(lens - 0.2) if i >= 10 else 1.0 if i < 3 else -abs(medial - 0.12)
        command = agent.observe(
            *(np.ones(N_FEATURES), places[-1], float(reward), i, first + i),
            learning=training,
            exploration=training,
        ).command
        places.append(command)
    return places


def _episode(
    agent: Agent, first: int, place: np.ndarray, wanted: np.ndarray, *, training: bool = True
) -> tuple[list[np.ndarray], list[Decision]]:
    """Return places and decisions of an episode; the reward falls with the distance to `wanted`."""
    places, decisions = [place], []
    for i in range(N):
        decision = agent.observe(
            np.ones(N_FEATURES),
            places[-1],
            -float(np.abs(places[-1] - wanted).sum()),
            i,
            first + i,
            learning=training,
            exploration=training,
        )
        decisions.append(decision)
        places.append(decision.command)
    return places, decisions


START, WANTED = np.array([0.1, 0.05, 0.2, 0.2]), np.array([0.12, 0.04, 0.1, 0.3])


def test_the_eyes_try_first_then_stay_and_one_lens_tries_after_the_other() -> None:
    places, _ = _episode(Agent(_config()), HELD, START, WANTED)
    changed = np.array([b != a for a, b in itertools.pairwise(places)])
    # Each rule's last command is without noise, and nothing is known yet. A lens begins anywhere.
    eyes, left, right = ([i in moved for i in range(4)] for moved in ({0, 1}, {2}, {3}))
    none = [False] * 4
    assert changed.tolist() == [eyes, eyes, eyes, left, left, right, right, none]
    lenses = [place[2:] for place in places[3:5]]
    assert np.abs(np.diff(lenses, axis=0)).max() > 0.1


def test_lenses_focus_first_and_the_eyes_do_not_learn_from_how_sharp_that_is() -> None:
    """Of ten iterations of the eyes' turn three; where these count, the eyes go back there."""
    agent = Agent(LONG)
    for k in range(2, 150):
        _long_episode(agent, k * 20)
    places = _long_episode(agent, 150 * 20)
    follows = [(b != a)[2] for a, b in itertools.pairwise(places)]
    assert follows[:10] == [True] * 3 + [False] * 6 + [True]
    # Towards the place that is felt to be right, 0.2, which a lens reaches by itself.
    assert abs(places[3][2] - 0.2) < 0.02
    found = [place[0] for place in _long_episode(agent, 0, training=False)]
    assert found[-1] == pytest.approx(0.12, abs=0.01)


def test_a_lens_is_anywhere_in_the_first_of_its_turn_then_goes_on_from_there() -> None:
    agent, tried = Agent(_config("pair_and_lens")), []
    for k in range(2, 80):
        places, _ = _episode(agent, k * N, START[:3], WANTED[:3])
        tried.append([place[2] for place in places[4:N]])
    spread, alike = np.std(tried, axis=0), np.corrcoef(tried, rowvar=False)
    away = np.abs(np.array(tried) - WANTED[2]).mean(axis=0)
    assert spread[:2] == pytest.approx(HIGHEST[2] / np.sqrt(12.0), rel=0.25)
    assert abs(alike[0, 1]) < 0.3
    assert np.diag(alike, 1)[1:].min() > 0.7
    assert away[-1] < 0.8 * away[:2].min()


def test_at_first_all_look_about_and_nothing_is_learned() -> None:
    agent = Agent(_config())
    before = {n: v for n, v in agent.state().items() if not n.startswith(("statistics", "learn"))}
    places = []
    for first in range(0, HELD, N):
        visited, _ = _episode(agent, first, START, WANTED)
        places += visited[1:]
    after = {name: agent.state()[name] for name in before}
    assert_same_state(after, before)
    tried = np.array(places) - START
    assert (tried != 0.0).all()
    # About the first place, not about the last one: 16 steps would lead four times as far.
    spread = np.array([0.0158, 0.0158, 0.05, 0.05])
    assert (np.sqrt((tried**2).mean(axis=0)) < 2.0 * spread).all()
    assert (np.array(places) <= HIGHEST).all()


def test_all_move_in_tests() -> None:
    agent = Agent(_config())
    for k in range(2, 12):
        _episode(agent, k * N, START, WANTED)
    state = agent.state()
    places, _ = _episode(agent, 0, START, WANTED, training=False)
    assert (places[1] != START).all()
    assert_same_state(agent.state(), state)


def test_a_lens_learns_from_what_is_felt_where_the_eyes_look() -> None:
    """It is wanted at twice the medial activation, and a tenth."""
    agent, draw = Agent(_config("pair_and_lens")), np.random.default_rng(1)
    n_episodes = 150
    for k in range(n_episodes):
        place = draw.uniform(0.0, HIGHEST[:3])
        eyes = np.append(draw.uniform(0.05, 0.1), 0.02)
        # The eyes are told where to be in the middle of the episode.
        _taught(agent, k * N, place, eyes)
    errors = []
    for medial in (0.05, 0.07, 0.1):
        place = np.array([medial, 0.02, 0.4])
        for i in range(20):
            command = agent.observe(
                *(np.ones(N_FEATURES), place, 0.0, i, 0), learning=False, exploration=False
            ).command
            place = np.array([medial, 0.02, command[2]])
        errors.append(abs(place[2] - (2.0 * medial + 0.1)))
    assert max(errors) < 0.02


def _taught(agent: Agent, first: int, place: np.ndarray, eyes: np.ndarray) -> None:
    """Reward a lens alone, before eyes that are held."""
    place = np.append(eyes, place[2])
    for i in range(N):
        reward = -abs(float(place[2] - (2.0 * eyes[0] + 0.1)))
        command = agent.observe(
            *(np.ones(N_FEATURES), place, reward, i, first + i), learning=True, exploration=True
        ).command
        place = np.append(eyes, command[2])


def test_the_eyes_are_told_of_the_first_scales_and_the_lenses_of_the_others() -> None:
    agent = Agent(_config())
    for k in range(2, 12):
        _episode(agent, k * N, START, WANTED)
    n = N_FEATURES // 2
    weights = {name: np.ones_like(w) for name, w in agent.state().items() if "actor" in name}
    statistics = {"statistics_count": np.array(9)}
    statistics["statistics_squared_deviation"] = np.ones(N_FEATURES + 4)
    agent.restore(agent.state() | weights | statistics)
    seen = np.ones(N_FEATURES)
    of_first = np.arange(N_FEATURES) < n
    as_it_is, first, others = (
        agent.observe(features, START, 0.0, 0, 0, learning=False, exploration=False).command
        for features in (seen, seen - 0.01 * of_first, seen - 0.01 * ~of_first)
    )
    assert (first != as_it_is).tolist() == [True, True, False, False]
    assert (others != as_it_is).tolist() == [False, False, True, True]


def test_eyes_go_by_what_they_feel_while_one_sees_nothing() -> None:
    agent = Agent(_config())
    for k in range(2, 12):
        _episode(agent, k * N, START, WANTED)
    n, state = N_FEATURES // 2, agent.state()
    assert state["felt_actor"].shape == (2, 4 + 1)
    agent.restore(state | {"felt_actor": np.full((2, 5), 0.003)})
    seen, covered = np.ones(N_FEATURES), np.ones(N_FEATURES)
    covered[:n] = 0.0
    felt = agent.observe(covered, START, 0.0, 0, 0, learning=False, exploration=False)
    assert felt.command[0] - START[0] == pytest.approx(felt.command[1] - START[1])
    with_both = agent.observe(seen, START, 0.0, 0, 0, learning=False, exploration=False)
    assert (with_both.command[:2] != felt.command[:2]).all()
    assert (with_both.command[2:] == felt.command[2:]).all()


def test_what_was_learned_is_restored_with_each_lens_of_its_own() -> None:
    agent = Agent(_config())
    for k in range(2, 12):
        _episode(agent, k * N, START, WANTED)
    state = agent.state()
    assert (state["lens_0_actor"] != state["lens_1_actor"]).any()
    assert state["actor"].shape == (2, N_FEATURES // 2 + 4 + 1)
    assert state["lens_0_actor"].shape == (1, N_FEATURES // 2 + 4 + 1)
    other = Agent(_config())
    other.restore(state)
    found, _ = _episode(other, 12 * N, START, WANTED)
    expected, _ = _episode(agent, 12 * N, START, WANTED)
    np.testing.assert_array_equal(found, expected)


def test_products_are_those_of_activations_that_turn_one_eye() -> None:
    assert _config("pair_and_lens", products_of_activations=True).n_felt == 3 + 3
    assert replace(TWELVE, products_of_activations=True).n_felt == 14 + 2 * 21


def test_lenses_need_some_tries_and_do_without_saccades() -> None:
    with pytest.raises(InputError, match="iterations_per_episode: expected 8 or more"):
        _config(iterations_per_episode=4, n_training_iterations=400)
    with pytest.raises(InputError, match="command_space: expected one without lenses"):
        replace(TWELVE, measures_turns=True)
