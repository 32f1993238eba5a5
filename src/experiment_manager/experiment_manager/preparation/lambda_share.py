"""How large lambda must be for the cost to have a given share of the reward (K17 II)."""

import math
import sys
from dataclasses import dataclass

from experiment_manager.experiment.protocol import protocol_of
from experiment_manager.experiment.sections import Configuration
from experiment_manager.in_process.loop import make_loop
from experiment_manager.measures.metrics import SHARE_ITERATIONS
from experiment_manager.terminal.progress_lines import progress


@dataclass(frozen=True)
class FirstIterations:
    """Means over the first training iterations of a run without a price on energy.

    reconstruction_error: E, both scales together; metabolic_rate_w: C, both eyes' horizontal recti.
    """

    n_iterations: int
    reconstruction_error: float
    metabolic_rate_w: float

    def weight_for(self, share: float) -> float:
        """Return lambda in 1/W such that lambda C / (E + lambda C) is the share, in [0, 1)."""
        return share * self.reconstruction_error / ((1.0 - share) * self.metabolic_rate_w)


def first_iterations(parameters: Configuration) -> FirstIterations:
    """Train a run's learners in process over its first 5,000 iterations, with lambda 0.

    The last episode of these is made whole, and all of it counts. parameters: of all nodes, by
    node.
    """
    free = with_weight(parameters, 0.0)
    protocol = protocol_of(free)
    per_episode = protocol.config.iterations_per_episode
    n_of_share = math.ceil(SHARE_ITERATIONS / per_episode) * per_episode
    n_iterations = min(n_of_share, protocol.config.n_training_iterations)
    error = cost_w = 0.0
    loop = make_loop(free)
    try:
        with progress(file=sys.stderr, total=n_iterations, desc="E and C", unit="it") as bar:
            for episode in protocol.training_episodes():
                if episode.training_iteration >= n_iterations:
                    break
                loop.plant.reconfigure(protocol.plant_settings(episode))
                answers = [step.answer for step in loop.run_episode(episode)]
                percepts = [answer.percept for answer in answers if answer]
                error += sum(float(p.encoding.reconstruction_error.sum()) for p in percepts)
                cost_w += sum(p.metabolic_rate_w for p in percepts)
                bar.update(episode.n_iterations)
    finally:
        loop.plant.close()
    return FirstIterations(n_iterations, error / n_iterations, cost_w / n_iterations)


def with_weight(parameters: Configuration, weight: float) -> Configuration:
    """Return the parameters of all nodes with another lambda, 1/W."""
    return parameters | {"task": parameters["task"] | {"metabolic_cost_weight": weight}}
