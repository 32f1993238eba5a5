"""Agents of stable-baselines3 with its defaults, in place of our learning rules.

They learn in the environment that is made for them, with the eyes, dictionaries and stimuli of a
run, and are tested as the run was.
"""

from collections.abc import Callable
from contextlib import closing

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.baselines.bench import Bench, Controller, Seen
from active_binocular_vision.baselines.extra import extra
from active_binocular_vision.environments.vector import VectorEnvironment

_N_SCORES = 5


def train(
    bench: Bench, algorithm: str, n_steps: int, scored: Callable[[int, Controller], None]
) -> None:
    """Train SAC, TD3 or PPO of stable-baselines3, whatever it is named there, for so many steps.

    scored: called five times, with the steps so far and the controller without exploration. An
    agent may make more steps than it is asked for: PPO makes 2048 at a time. Raises InputError
    without the package, and for a run without a checkpoint.
    """
    sb3 = extra("stable_baselines3")
    extra("torch").set_num_threads(1)
    space = bench.manager.space
    with closing(VectorEnvironment(eyes=bench.directory, settings=bench.stimuli)) as environment:
        agent = getattr(sb3, algorithm)("MlpPolicy", environment, seed=bench.manager.seed)

        def controller(seen: Seen) -> NDArray[np.float64]:
            felt = space.from_all(seen.activations)
            observed = environment.vector(seen.code.features, felt)
            action, _ = agent.predict(observed, deterministic=True)
            return felt + environment.action_scale * action

        for i in range(_N_SCORES):
            due = n_steps * (i + 1) // _N_SCORES
            if due > agent.num_timesteps:
                agent.learn(due - agent.num_timesteps, reset_num_timesteps=i == 0)
                scored(agent.num_timesteps, controller)
