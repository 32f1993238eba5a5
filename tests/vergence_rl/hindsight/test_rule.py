import dataclasses
import math

import numpy as np
import pytest

from lockstep import DivergenceError, generator
from tests.vergence_rl.probe import gaze_errors, trained_on_gazes
from tests.vergence_rl.small_agents import (
    HIGHEST,
    HINDSIGHT,
    MEAN,
    MID,
    Floats,
    changed,
    experience,
    slow_state,
    train,
    trained,
)
from vergence_rl import Agent, VergenceRlConfig
from vergence_rl.hindsight.config import HindsightConfig
from vergence_rl.hindsight.noise import root_of
from vergence_rl.hindsight.rule import HindsightRule
from vergence_rl.learning_rule import TimeStep

# The same as MEAN with distances in the shape of the noise.
IN_NOISE = changed(MEAN, {"hindsight.target_noise_scale": 3.0})
# And with noise that never gets much narrower than it was.
WIDE = changed(IN_NOISE, {"hindsight.least_noise_share": 0.8})


class SlowRule:
    """The same rule with every visit kept, weighted and regressed each time; no running sums."""

    def __init__(self, config: VergenceRlConfig) -> None:
        self.config = config
        n_state = config.n_features + 3
        self.actor = np.zeros((2, n_state))
        self.covariance = config.hindsight.exploration_variance * np.eye(2)
        self.prior = config.hindsight.least_memory
        self.selected = self.covariance.copy()
        self.asked = self.noise = np.zeros(2)
        self.kept: list[tuple[Floats, Floats, float]] = []  # state, target, weight
        # state, place, reward, what was asked for, its noise
        self.episode: list[tuple[Floats, Floats, float, Floats, Floats]] = []

    def learn(self, state: Floats, place: Floats, reward: float, i: int, now: int) -> None:
        if i == 0:
            self.episode = []
            self.asked = place
        self.episode.append((state, place, reward, self.asked, self.noise))
        if i == 4:
            self.end_episode(now + 1)

    def end_episode(self, n_seen: int) -> None:
        memory = max(60.0, 0.5 * n_seen)
        share = math.exp(-5 / memory)
        self.prior *= share
        self.kept = [(s, t, w * share) for s, t, w in self.kept]
        best = max(self.episode, key=lambda visit: visit[2])[1]
        is_mean = self.config.hindsight.n_best > 1
        if is_mean:
            best = self.mean()
        for state, place, *_ in self.episode:
            weight = self.weight(best - place)
            aim = best if is_mean else self.aim(best, self.wanted(state, place))
            self.kept.append((state, aim - place, weight))
        self.note_noise(share)
        if n_seen % 20 == 0:
            self.solve(0.01 + self.config.hindsight.ridge_visits / memory)
            if is_mean:
                self.covariance = self.selected
            variances, axes = np.linalg.eigh(self.covariance)
            least_sd = self.config.hindsight.least_noise_share
            least = least_sd**2 * self.config.hindsight.exploration_variance
            self.covariance = axes @ np.diag(np.maximum(variances, least)) @ axes.T

    def weight(self, away: Floats) -> float:
        scale = self.config.hindsight.target_noise_scale
        if not scale:
            return 0.005**2 / (0.005**2 + float(away @ away))
        floored = self.covariance + 1e-6 * np.trace(self.covariance) / 2.0 * np.eye(2)
        return scale**2 / (scale**2 + float(away @ np.linalg.inv(floored) @ away))

    def wanted(self, state: Floats, place: Floats) -> Floats:
        return place + self.actor @ state

    def rank_weights(self) -> list[float]:
        n_best = self.config.hindsight.n_best
        raw = [math.log(n_best + 0.5) - math.log(rank + 1) for rank in range(n_best)]
        return [w / sum(raw) for w in raw]

    def note_noise(self, share: float) -> None:
        moved = sorted(self.episode[1:], key=lambda visit: -visit[2])
        self.selected = share * self.selected
        for w, visit in zip(self.rank_weights(), moved, strict=False):
            carried_out = self.allowed(visit[3]) - self.allowed(visit[3] - visit[4])
            self.selected = self.selected + (1.0 - share) * w * np.outer(carried_out, carried_out)

    def allowed(self, asked: Floats) -> Floats:
        """Of the places at the limits and between them, the nearest; or what was asked for."""
        edges = [asked] if (asked >= 0.0).all() and (asked <= HIGHEST).all() else []
        metric = np.linalg.inv(self.covariance)
        for k in (0, 1):
            for limit in (0.0, HIGHEST[k]):
                edge = np.zeros(2)
                edge[k] = limit
                along = -metric[k, 1 - k] / metric[1 - k, 1 - k] * (limit - asked[k])
                edge[1 - k] = np.clip(asked[1 - k] + along, 0.0, HIGHEST[1 - k])
                edges.append(edge)
        return min(edges, key=lambda at: float((at - asked) @ metric @ (at - asked)))

    def mean(self) -> Floats:
        by_reward = sorted(self.episode, key=lambda visit: -visit[2])
        ranked = list(zip(self.rank_weights(), by_reward, strict=False))
        place: Floats = sum((w * visit[1] for w, visit in ranked), np.zeros(2))
        asked: Floats = sum((w * visit[3] for w, visit in ranked), np.zeros(2))
        held = [k for k in (0, 1) if not 0.0 <= asked[k] <= HIGHEST[k]]
        if len(held) == 2:
            return asked
        for k in held:
            slope = self.covariance[1 - k, k] / self.covariance[k, k]
            place[1 - k] += slope * (asked[k] - place[k])
            place[k] = asked[k]
        return place

    def aim(self, best: Floats, wanted: Floats) -> Floats:
        held = [
            (best[k] == 0 and wanted[k] < 0) or (best[k] == HIGHEST[k] and wanted[k] > HIGHEST[k])
            for k in (0, 1)
        ]
        if all(held) or not any(held):
            return wanted if all(held) else best
        k = held.index(True)
        slope = self.covariance[1 - k, k] / self.covariance[k, k]
        aim = best.copy()
        aim[k] = wanted[k]
        aim[1 - k] += slope * (wanted[k] - best[k])
        return aim

    def solve(self, ridge_share: float) -> None:
        states = np.array([s for s, _, _ in self.kept])
        targets = np.array([t for _, t, _ in self.kept])
        weights = np.array([w for _, _, w in self.kept])
        root = np.sqrt(weights)[:, None]
        ridge = ridge_share * np.mean(((root * states) ** 2).sum(axis=0))
        n_state = states.shape[1]
        shares = np.ones(n_state)
        shares[self.config.n_features :] = self.config.hindsight.felt_ridge_share
        rows = np.concatenate([root * states, np.diag(np.sqrt(ridge * shares))])
        aims = np.concatenate([root * targets, np.zeros((n_state, 2))])
        self.actor = np.linalg.lstsq(rows, aims, rcond=None)[0].T
        left = root * (targets - states @ self.actor.T)
        first = self.prior * self.config.hindsight.exploration_variance * np.eye(2)
        self.covariance = (left.T @ left + first) / (weights.sum() + self.prior)


@pytest.mark.parametrize("config", [HINDSIGHT, MEAN, IN_NOISE, WIDE])
def test_agrees_with_a_slow_rule_that_keeps_all_visits(config: VergenceRlConfig) -> None:
    agent, slow = Agent(config), SlowRule(config)
    n_cut = 0
    for now in range(400):
        (got,), (_, place, reward) = train(agent, now, 1), experience(now)
        state = slow_state(config, now)
        slow.learn(state, place, reward, now % 5, now)
        noise = generator(1, "exploration", now).normal(0.0, 1.0, 2)
        slow.noise = root_of(slow.covariance) @ noise
        action = slow.actor @ state + slow.noise
        slow.asked = place + action
        np.testing.assert_allclose(got.action, action, rtol=1e-6, atol=1e-9)
        wanted = place + action
        inside = np.all((wanted >= 0.0) & (wanted <= HIGHEST))
        n_cut += not inside
        if inside:
            np.testing.assert_allclose(got.command, wanted, atol=1e-9)
        else:
            assert np.all((got.command >= 0.0) & (got.command <= HIGHEST))
    assert n_cut > 30
    np.testing.assert_allclose(agent.state()["actor"], slow.actor, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(agent.state()["covariance"], slow.covariance, rtol=1e-6)


def test_two_muscles_learn_a_gaze_and_to_relax_if_that_pays() -> None:
    idle = {}
    for price in (0.0, 0.3):
        agent = Agent(VergenceRlConfig(learning_rule="hindsight", n_bases=1))
        trained_on_gazes(agent, 600, price)
        errors, places = gaze_errors(agent)
        assert errors.max() < 0.003
        idle[price] = places.min(axis=1).mean()
    assert idle[0.3] < 0.6 * idle[0.0]


def test_noise_that_does_not_follow_residuals_stays_as_it_began() -> None:
    agent = Agent(changed(HINDSIGHT, {"hindsight.exploration_follows_residuals": False}))
    for now, decision in enumerate(train(agent, 0, 60)):
        # With the same width in both muscles, one does not make up for the other.
        wanted = experience(now)[1] + decision.action
        np.testing.assert_allclose(decision.command, np.clip(wanted, 0.0, HIGHEST), atol=1e-12)
    np.testing.assert_array_equal(agent.state()["covariance"], 2.5e-4 * np.eye(2))
    assert np.any(agent.state()["actor"] != 0.0)


def test_places_that_are_not_compared_are_learned_from_and_never_learned() -> None:
    """The eyes are best where they begin, if that counts; else one step of 0.01 farther."""
    ends = {}
    for counts in (True, False):
        config = HindsightConfig(regression_period=5, target_scale=0.1, ridge_share=1e-6)
        rule = HindsightRule(config, dataclasses.replace(HINDSIGHT.task, n_state=3))
        for now in range(400):
            i = now % 5
            place, state = np.array([0.05 + 0.01 * i, 0.05]), np.array([i - 2.0, 0.0, 1.0])
            seen = TimeStep(i, now, state, place, -float(i), is_compared=counts or i > 0)
            decision = rule.step(seen, learning=True, draw=None)
        assert decision.value == (0.0 if counts else -1.0)
        ends[counts] = rule.state()["actor"] @ np.array([-2.0, 0.0, 1.0])
    assert ends[True] == pytest.approx([0.0, 0.0], abs=0.002)
    assert ends[False] == pytest.approx([0.01, 0.0], abs=0.002)


def test_what_is_reported_of_places_that_are_not_compared() -> None:
    rule = HindsightRule(HINDSIGHT.hindsight, HINDSIGHT.task)
    state, decisions = np.ones(HINDSIGHT.n_state), []
    for i, reward in enumerate((-1.0, -2.0, -3.0, -2.5, -2.9)):
        seen = TimeStep(i, i, state, MID, reward, is_compared=i > 1)
        decisions.append(rule.step(seen, learning=True, draw=None))
    assert [d.value for d in decisions] == [-1.0, -2.0, -3.0, -2.5, -2.5]
    errors = [d.td_error for d in decisions]
    assert errors == pytest.approx([math.nan] * 3 + [0.5, -0.4], nan_ok=True)


def test_an_episode_with_a_gap_teaches_nothing() -> None:
    agent = trained(HINDSIGHT, 40)
    before = agent.state()
    for t in (40, 41, 43, 44):
        agent.observe(*experience(t), t % 5, t, learning=True, exploration=True)
    after = agent.state()
    for name in ("actor", "covariance", "sum_products", "sum_squares", "sum_targets"):
        np.testing.assert_array_equal(after[name], before[name])
    assert after["learning_steps"] == before["learning_steps"] + 2


def test_what_is_reported() -> None:
    agent = Agent(HINDSIGHT)
    decisions = train(agent, 0, 10)
    rewards = [experience(t)[2] for t in range(10)]
    for start in (0, 5):
        assert math.isnan(decisions[start].td_error)
        for t in range(start + 1, start + 5):
            before = max(rewards[start:t])
            assert decisions[t].td_error == pytest.approx(rewards[t] - before)
            assert decisions[t].value == max(before, rewards[t])
    assert decisions[-1].actor_learning_rate == pytest.approx(1 - math.exp(-5 / 60))
    assert decisions[-1].critic_learning_rate == 0.0
    expected = 1.0
    for decision in decisions:
        if not math.isnan(decision.td_error):
            expected = 0.999 * expected + 0.001 * decision.td_error**2
    assert decisions[-1].td_variance == pytest.approx(expected)
    in_test = agent.observe(*experience(3), 0, 10, learning=False, exploration=False)
    assert in_test.value == rewards[3]


def test_rewards_that_run_away_end_learning() -> None:
    agent, (features, place, _) = Agent(HINDSIGHT), experience(0)
    with pytest.raises(DivergenceError, match="iteration 0: value is 1000, expected 100 at most"):
        agent.observe(features, place, 1000.0, 0, 0, learning=True, exploration=True)
