"""The project's actor-critic, trained through the Gymnasium environment.

The numbers are those of the graph and of the in-process loop, bit for bit: the test of this file
holds it to that. Put your own agent in place of `Agent`.

usage: .venv/bin/python docs/examples/gymnasium_agent.py [EPISODES]
"""

import sys
from collections import deque

import gymnasium
import numpy as np

from vergence_rl import Agent, VergenceRlConfig


def train(environment: gymnasium.Env, agent: Agent, n_episodes: int, seed: int) -> list[float]:
    """Train for so many episodes; return the vergence error in deg at the end of each."""
    scale = environment.unwrapped.action_scale
    errors_deg = []
    for i_episode in range(n_episodes):
        observed, info = environment.reset(seed=seed if i_episode == 0 else None)
        reward, truncated = info["reward"], False
        while not truncated:
            truth = info["ground_truth"]  # for its count of iterations
            decision = agent.observe(
                observed["features"],
                observed["activations"],
                reward,
                int(truth["iteration"]),
                int(truth["training_iteration"]),
                learning=True,
                exploration=True,
            )
            action = np.clip(decision.action / scale, -1.0, 1.0)
            observed, reward, _, truncated, info = environment.step(action)
        errors_deg.append(info["ground_truth"]["vergence_error_deg"])
    return errors_deg


def main() -> None:
    """Train on the generated stimuli, and print the running median error."""
    n_episodes = int(sys.argv[1]) if len(sys.argv) > 1 else 2000
    seed = 1
    environment = gymnasium.make("active_binocular_vision.environments:ActiveVergenceFeatures-v0")
    agent = Agent(
        VergenceRlConfig(
            seed=seed, n_training_iterations=10 * n_episodes, output_initial_width=0.07
        )
    )
    latest = deque(maxlen=200)
    for first in range(0, n_episodes, 100):
        start_with = seed if first == 0 else None
        latest += train(environment, agent, min(100, n_episodes - first), start_with)
        print(f"{10 * (first + 100):7d} iterations: {np.median(np.abs(latest)):.3f} deg")
    environment.close()


if __name__ == "__main__":
    main()
