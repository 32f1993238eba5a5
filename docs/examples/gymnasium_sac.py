"""Soft actor-critic of stable-baselines3 in place of the project's actor-critic.

stable-baselines3 is no dependency of the project:
`.venv/bin/python -m pip install stable-baselines3`.

Why these settings: a coder that learns changes what features mean, and stored experience becomes
invalid. Most features are small, a few large. E differs from stimulus to stimulus, and SAC weighs
reward against entropy, so the reward is the improvement, normalised. An action has its effect at
once, so gamma is small, as in K17. Steps of up to 5 deg reach every object within an episode, and
hit correct gaze by chance.

usage: .venv/bin/python docs/examples/gymnasium_sac.py [STEPS] [CSV]
"""

import sys
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from gymnasium_scores import (
    CURVE_HEADER,
    HEADER,
    RUNNING,
    WRITTEN_EVERY,
    Policy,
    make_environment,
    score,
)
from stable_baselines3 import SAC
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.vec_env import DummyVecEnv, VecNormalize

ACTION_SCALE = 1 / 32  # an action is at most 5 deg of vergence


class Improvement(gymnasium.Wrapper):
    """The reward is by how much better the pictures are coded than before the action.

    How well a picture can be coded at all varies as much as vergence makes it vary.
    """

    def reset(self, **options):
        """Begin an episode."""
        observed, info = self.env.reset(**options)
        self._before = _reward(info)
        return observed, info

    def step(self, action):
        """Act."""
        observed, _, terminated, truncated, info = self.env.step(action)
        gained = _reward(info) - self._before
        self._before += gained
        return observed, gained, terminated, truncated, info


def _reward(info: dict) -> float:
    """Return the reward of model M: -E (K17 eq. 5)."""
    return -(info["reconstruction_error_coarse"] + info["reconstruction_error_fine"])


def training_environment() -> gymnasium.Env:
    """Return the environment as SAC takes it: one vector of float32."""
    environment = Improvement(make_environment(ACTION_SCALE))
    environment = gymnasium.wrappers.FlattenObservation(environment)
    space = gymnasium.spaces.Box(0.0, np.inf, environment.observation_space.shape, np.float32)
    return Monitor(gymnasium.wrappers.TransformObservation(environment, _scaled, space))


def _scaled(observed: np.ndarray) -> np.ndarray:
    return np.sqrt(observed, dtype=np.float32)


class Curve(BaseCallback):
    """Writes the running median of the error at the end of each episode."""

    def __init__(self, path: Path) -> None:
        """path: of the table that is written."""
        super().__init__()
        self._path = path
        self._errors_deg: list[float] = []

    def _on_training_start(self) -> None:
        self._path.write_text(f"{CURVE_HEADER}\n")

    def _on_step(self) -> bool:
        for info in self.locals["infos"]:
            if "episode" in info:
                self._errors_deg.append(abs(info["ground_truth"]["vergence_error_deg"]))
                if len(self._errors_deg) % WRITTEN_EVERY == 0:
                    error_deg = np.median(self._errors_deg[-RUNNING:])
                    with self._path.open("a") as table:
                        table.write(f"{self.num_timesteps},{error_deg:.4f}\n")
                    print(f"{self.num_timesteps:7d} steps: {error_deg:.3f} deg", flush=True)
        return True


def policy_of(agent: SAC, normalized: VecNormalize, space: gymnasium.Space) -> Policy:
    """Return the agent without exploration, as a policy for `score`.

    space: of the observations that the policy is given.
    """

    def policy(observed: dict[str, np.ndarray], reward: float, info: dict[str, Any]) -> np.ndarray:
        flat = _scaled(gymnasium.spaces.flatten(space, observed))
        action, _ = agent.predict(normalized.normalize_obs(flat), deterministic=True)
        return ACTION_SCALE * action

    return policy


def main() -> None:
    """Train for so many steps, then test."""
    n_steps = int(sys.argv[1]) if len(sys.argv) > 1 else 20_000
    path = Path(sys.argv[2] if len(sys.argv) > 2 else "sac_curve.csv")
    environment = VecNormalize(DummyVecEnv([training_environment]), gamma=0.3)
    agent = SAC(
        "MlpPolicy",
        environment,
        gamma=0.3,  # as in K17: what an action brings, it brings at once
        learning_rate=1e-3,
        buffer_size=20_000,
        learning_starts=2000,
        train_freq=2,
        ent_coef="auto_0.1",
        policy_kwargs={"net_arch": [64, 64]},
        seed=1,
    )
    agent.learn(n_steps, callback=Curve(path))
    tested = make_environment(ACTION_SCALE)
    row = score(tested, policy_of(agent, environment, tested.observation_space))
    print(HEADER)
    print(f"{f'SAC, {n_steps} steps':24s}{row}")
    tested.close()
    environment.close()


if __name__ == "__main__":
    main()
