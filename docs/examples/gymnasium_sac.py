"""Soft actor-critic of stable-baselines3 in place of the project's actor-critic.

stable-baselines3 is no dependency of the project: `.venv/bin/pip install stable-baselines3`, with
PyTorch about 200 MB without a GPU. Features are normalised by its VecNormalize.

usage: .venv/bin/python docs/examples/gymnasium_sac.py [STEPS] [CSV]
"""

import sys
from pathlib import Path

import gymnasium
import numpy as np
from stable_baselines3 import SAC
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.vec_env import DummyVecEnv, VecNormalize

RUNNING = 200  # episodes


def make_environment() -> gymnasium.Env:
    """Return the environment as SAC takes it: one vector of float32."""
    # At first SAC acts at random over the whole range of actions: it is to be a few pixels wide.
    environment = gymnasium.make(
        "experiment_manager.environments:ActiveVergenceFeatures-v0", action_scale=1 / 64
    )
    environment = gymnasium.wrappers.FlattenObservation(environment)
    environment = gymnasium.wrappers.DtypeObservation(environment, np.float32)
    return Monitor(environment)


class Curve(BaseCallback):
    """Writes the running median of the error at the end of each episode."""

    def __init__(self, path: str) -> None:
        """path: of the table that is written."""
        super().__init__()
        self._path = Path(path)
        self._errors_deg: list[float] = []
        self._rows = ["step,running_median_error_deg"]

    def _on_step(self) -> bool:
        for info in self.locals["infos"]:
            if "episode" in info:
                self._errors_deg.append(abs(info["ground_truth"]["vergence_error_deg"]))
                if len(self._errors_deg) % 20 == 0:
                    error_deg = np.median(self._errors_deg[-RUNNING:])
                    self._rows.append(f"{self.num_timesteps},{error_deg:.4f}")
                    print(f"{self.num_timesteps:7d} steps: {error_deg:.3f} deg")
        return True

    def _on_training_end(self) -> None:
        self._path.write_text("\n".join(self._rows) + "\n")


def main() -> None:
    """Train for so many steps."""
    n_steps = int(sys.argv[1]) if len(sys.argv) > 1 else 20_000
    path = sys.argv[2] if len(sys.argv) > 2 else "sac_curve.csv"
    environment = VecNormalize(DummyVecEnv([make_environment]), norm_reward=False)
    # The reward of a step is all that counts, much as in K17, whose discount is 0.3.
    agent = SAC("MlpPolicy", environment, gamma=0.3, learning_starts=500, seed=1)
    agent.learn(n_steps, callback=Curve(path))
    environment.close()


if __name__ == "__main__":
    main()
