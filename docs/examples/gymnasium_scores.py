"""Scores in the same trials: random actions, the least possible, and hindsight regression.

All with the trained dictionaries of `results/precise`, seed 1, which do not learn. Hindsight
regression is trained for STEPS steps first.

usage: .venv/bin/python docs/examples/gymnasium_scores.py [STEPS]

On a machine that is busy, set OMP_NUM_THREADS=1.
"""

import dataclasses
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from gymnasium_agent import train

from active_binocular_vision.runs.results_folder import runs_at
from experiment_manager.sections import config_of
from eye_plant import EyePlantConfig, Inverse
from vergence_rl import Agent, VergenceRlConfig

PRECISE = Path(__file__).parents[2] / "results" / "precise"
N_TRIALS, TESTED_EVERY = 1560, 10
HEADER = "policy                  |error|/deg  quartiles     within 1 px  reward  steps/s"
Policy = Callable[[dict[str, np.ndarray], float, dict[str, Any]], np.ndarray]


def make_environment() -> gymnasium.Env:
    """Return the environment of all scores; its dictionaries do not learn."""
    return gymnasium.make(
        "active_binocular_vision.environments:ActiveVergenceFeatures-v0",
        settings={
            "eyes.camera.roi_width_px": 128,
            "eyes.camera.roi_height_px": 128,
        },
        coder_state=PRECISE / "sparse_coder_seed_1.npz",
        coder_learns=False,
    )


def score(environment: gymnasium.Env, policy: Policy) -> str:
    """Return the rest of a row of the table: the state after 20 steps on unseen stimuli.

    policy: of observation, reward and info; returns the change of activations.
    """
    errors_deg, rewards, n_steps, start = [], [], 0, time.perf_counter()
    environment.reset(seed=1)
    for trial in range(0, N_TRIALS, TESTED_EVERY):
        observed, info = environment.reset(options={"trial": trial})
        reward, truncated = info["reward"], False
        while not truncated:
            change = policy(observed, reward, info)
            action = np.clip(change / environment.unwrapped.action_scale, -1.0, 1.0)
            observed, reward, _, truncated, info = environment.step(action)
            n_steps += 1
        errors_deg.append(abs(info["ground_truth"]["vergence_error_deg"]))
        rewards.append(reward)
    low, middle, high = np.percentile(errors_deg, (25, 50, 75))
    within = np.mean(np.array(errors_deg) <= 0.22)
    rate = n_steps / (time.perf_counter() - start)
    error = f"{middle:11.3f}  {low:.3f}, {high:.3f}  {within:11.1%}"
    return f"{error}  {np.mean(rewards):6.3f}  {rate:7.0f}"


def random_policy(environment: gymnasium.Env) -> Policy:
    """Return actions that are uniform in the action space."""
    environment.action_space.seed(1)
    scale = environment.unwrapped.action_scale
    return lambda observed, reward, info: scale * environment.action_space.sample()


def best_policy() -> Policy:
    """Return the policy that knows the truth: the least activations with vergence correct."""
    inverse = Inverse(EyePlantConfig().mechanics)

    def policy(observed: dict[str, np.ndarray], reward: float, info: dict[str, Any]) -> np.ndarray:
        pair = inverse.optimal(info["ground_truth"]["desired_vergence_deg"])
        return np.array((pair.medial, pair.lateral)) - observed["activations"]

    return policy


def trained_policy(environment: gymnasium.Env, n_steps: int) -> Policy:
    """Return hindsight regression as in `precise`, trained for so many steps, frozen."""
    (run,) = runs_at(PRECISE / "profile_precise-seed_1")
    trained = config_of(VergenceRlConfig, run.configuration)
    agent = Agent(dataclasses.replace(trained, n_training_iterations=n_steps))
    train(environment, agent, n_steps // 10, seed=1)

    def policy(observed: dict[str, np.ndarray], reward: float, info: dict[str, Any]) -> np.ndarray:
        decision = agent.observe(
            observed["features"],
            observed["activations"],
            reward,
            int(info["ground_truth"]["iteration"]),
            int(info["ground_truth"]["training_iteration"]),
            learning=False,
            exploration=False,
        )
        return decision.action

    return policy


def main() -> None:
    """Print the table."""
    n_steps = int(sys.argv[1]) if len(sys.argv) > 1 else 20_000
    environment = make_environment()
    print(HEADER)
    for name, policy in (
        ("random", random_policy(environment)),
        ("least possible", best_policy()),
        (f"hindsight, {n_steps} steps", trained_policy(environment, n_steps)),
    ):
        print(f"{name:24s}{score(environment, policy)}", flush=True)
    environment.close()


if __name__ == "__main__":
    main()
