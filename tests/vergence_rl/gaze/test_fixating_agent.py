"""An agent that makes saccades, or measures its turns: what its rule sees of them."""

import math

import numpy as np
import pytest

from tests.vergence_rl.small_agents import GAZE, changed, knowing, observation, train, trained
from vergence_rl import Agent, Decision

_UNSEEN = np.full((2, 3), np.nan)


def test_a_rule_learns_from_what_follows_the_saccades_alone() -> None:
    agent, now = knowing(GAZE)
    known, n_steps = agent.state(), agent.learning_steps
    decisions = train(agent, now, 20)
    # A saccade reports no TD error, and neither does the first iteration of vergence.
    undefined = [math.isnan(d.td_error) for d in decisions]
    assert undefined == [True, True, True, False, False] * 4
    assert agent.state()["left_eye_n_movements"] == known["left_eye_n_movements"] + 4
    assert agent.state()["sum_weight"] != known["sum_weight"]
    # As for all eyes: one step for each iteration but the first of an episode.
    assert agent.learning_steps == n_steps + 18


def test_until_movements_are_known_nothing_is_learned_of_vergence_and_the_eyes_stay() -> None:
    agent = Agent(GAZE)
    decisions = train(agent, 0, 20)
    assert all(math.isnan(d.td_error) for d in decisions)
    assert not agent.state()["actor"].any()
    moved = [np.abs(d.action).max() > 0.0 for d in decisions]
    # The first saccade is noise, and the second would correct what is not known.
    assert moved == [True, False, False, False, False] * 4
    assert agent.learning_steps == 18


def test_products_of_activations_are_of_one_eye() -> None:
    assert GAZE.n_felt == 12 + 2 * 21
    means = trained(GAZE, 10).state()["statistics_mean"]
    assert len(means) == 6 + 2 * 21 + 12
    assert 0.005 < means[6:48].min() < means[6:48].max() < 0.02


def test_vergence_is_learned_after_a_saccade_that_was_not_seen() -> None:
    agent, now = knowing(GAZE)
    known = agent.state()
    decisions = []
    for t in range(now, now + 40):
        target_deg = np.array([1.0, 2.0]) * (1.0 if t % 5 == 0 else np.nan)  # no second saccade
        seen = observation(GAZE, t, target_deg=target_deg, turns_deg=_UNSEEN)
        decisions.append(agent.observe(**seen))
    assert [math.isnan(d.td_error) for d in decisions] == [True, True, True, False, False] * 8
    state = agent.state()
    assert state["left_eye_n_movements"] == known["left_eye_n_movements"]
    assert (state["actor"] != known["actor"]).any()


def _priced(agent: Agent, now: int, penalty: float) -> list[Decision]:
    """Return the decisions of two episodes whose rewards are less by the penalty."""
    seen = [observation(GAZE, t, energy_penalty=penalty) for t in range(now, now + 20)]
    return [agent.observe(**o | {"reward": o["reward"] - penalty}) for o in seen]


@pytest.mark.parametrize("n_best", [1, 2])  # as many as a fixation has, less one
def test_the_penalty_is_learned_and_hidden_from_the_rule(n_best: int) -> None:
    """The rule's best places are those of most reward without it."""
    (bare, now), (priced, _) = (knowing(GAZE, **{"hindsight.n_best": n_best}) for _ in range(2))
    before = bare.state()["actor"]
    for one, other in zip(_priced(bare, now, 0.0), _priced(priced, now, 0.5), strict=True):
        assert one.td_error == pytest.approx(other.td_error, nan_ok=True)
    assert (bare.state()["actor"] != before).any()
    np.testing.assert_allclose(bare.state()["actor"], priced.state()["actor"])
    assert (bare.state()["effort_products"] != priced.state()["effort_products"]).any()


def test_without_saccades_vergence_is_learned_from_what_follows_the_first_command() -> None:
    config = changed(GAZE, {"fixation_iterations": 0, "measures_turns": True})
    agent, draw = Agent(config), np.random.default_rng(5)

    def verged(first: int, n: int) -> list[Decision]:
        """Return the decisions of n iterations; two movements of an episode are seen."""
        turns_deg = [draw.normal(0, 1, (2, 3)) if t % 10 in {1, 6} else _UNSEEN for t in range(n)]
        return [
            agent.observe(
                **observation(config, first + t, target_deg=np.full(2, np.nan), turns_deg=turned)
            )
            for t, turned in enumerate(turns_deg)
        ]

    # The eyes are shaken until it is known how they turn: 336 movements, two of an episode.
    decisions = verged(0, 1680)
    assert all(math.isnan(d.td_error) for d in decisions[:-4])
    assert all(np.abs(d.action).max() > 0.0 for d in decisions)
    decisions = verged(1680, 20)
    assert [math.isnan(d.td_error) for d in decisions] == ([True] * 2 + [False] * 8) * 2
    assert agent.state()["actor"].any()
