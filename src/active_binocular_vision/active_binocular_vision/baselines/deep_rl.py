"""Agents of stable-baselines3 with its defaults, in place of our learning rules.

The task is made as easy for them as their users would make it: dictionaries that are learned and
stay, square roots of features, normalised observations and rewards, the reward's improvement over
the picture before, and steps small enough to hold correct gaze.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import gymnasium
import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray

from active_binocular_vision.baselines.bench import Bench, Controller, Seen
from active_binocular_vision.baselines.extra import extra
from eye_plant import Observation

Vector = NDArray[np.float32]

# Change of an activation by an action of 1: of the pair, at most 5 deg of vergence.
ACTION_SCALE = 1.0 / 32.0
# Called between two episodes, with the steps so far.
Pause = Callable[[int], None]


class VergenceTask(gymnasium.Env[Vector, NDArray[np.float32]]):
    """The training episodes of a bench, one after the other; a step earns what E falls by."""

    def __init__(self, bench: Bench, pause: Pause = lambda _: None) -> None:
        """bench: whose episodes, eyes and dictionaries these are, which a pause may use."""
        self._bench, self._pause = bench, pause
        self._episodes = bench.protocol.training_episodes()
        self._n_steps = 0
        n_observed = 2 * bench.manager.n_bases + len(bench.plant.oculomotor.tonic_activations)
        self.observation_space = Box(0.0, np.inf, (n_observed,))
        self.action_space = Box(-1.0, 1.0, (len(bench.manager.space.names),))

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Vector, dict[str, Any]]:
        """Begin the next training episode; with a seed the first one, since the run has its own."""
        super().reset(seed=seed)
        self._pause(self._n_steps)
        if seed is not None:
            self._episodes = self._bench.protocol.training_episodes()
        episode = next(self._episodes, None)
        if episode is None:
            self._episodes = self._bench.protocol.training_episodes()
            episode = next(self._episodes)
        # The agent acts in all iterations of the episode, and sees what the last act led to.
        longer = replace(episode, n_iterations=episode.n_iterations + 1)
        return self._observe(self._bench.plant.begin(longer)), {}

    def _observe(self, now: Observation) -> Vector:
        self._now, self._seen = now, self._bench.given(now)
        return self._seen.state.astype(np.float32)

    def step(self, action: NDArray[np.float32]) -> tuple[Vector, float, bool, bool, dict[str, Any]]:
        """Change the activations."""
        self._n_steps += 1
        before = self._seen
        found = self._observe(self._bench.executed(acted(self._bench, before, action)))
        gained = before.error - self._seen.error
        is_last = self._now.iteration == self._now.episode.n_iterations - 1
        return found, gained, False, is_last, {}


def acted(bench: Bench, seen: Seen, action: NDArray[np.float32]) -> NDArray[np.float64]:
    """Return the activations (n_commands,) that an action (n_commands,) in [-1, 1] asks for."""
    return bench.manager.space.from_all(seen.activations) + ACTION_SCALE * action


def train(
    bench: Bench,
    algorithm: str,
    n_steps: int,
    scored: Callable[[int, Controller], None],
    every: int,
) -> None:
    """Train SAC, TD3 or PPO of stable-baselines3, whatever it is named there, for so many steps.

    scored: called after each `every` steps, once an episode has ended, with the steps so far and
    the controller without exploration. Raises InputError without the package.
    """
    sb3, vectors = extra("stable_baselines3"), extra("stable_baselines3.common.vec_env")
    extra("torch").set_num_threads(1)
    n_scored = 0

    def pause(n_so_far: int) -> None:
        nonlocal n_scored
        if n_so_far >= n_scored + every:
            n_scored = n_so_far
            scored(n_so_far, controller)

    task = VergenceTask(bench, pause)
    environment = vectors.VecNormalize(vectors.DummyVecEnv([lambda: task]))
    agent = getattr(sb3, algorithm)("MlpPolicy", environment, seed=bench.manager.seed)

    def controller(seen: Seen) -> NDArray[np.float64]:
        normalized = environment.normalize_obs(seen.state.astype(np.float32))
        action, _ = agent.predict(normalized, deterministic=True)
        return acted(bench, seen, action)

    agent.learn(n_steps)
