"""Find the lambda with which energy has a share of the reward (K17 II).

usage: .venv/bin/python sweeps/lambda_share.py SHARE [options of run_experiment.sh]

Trains in this process over the first 5,000 iterations with lambda 0, and takes the means of the
reconstruction error E and of the metabolic rate C: lambda C / (E + lambda C) is the share then.
"""

import sys

import numpy as np

from active_binocular_vision.commands.command_line import arguments, request_of
from experiment_manager.loop import make_loop
from experiment_manager.measures.metrics import SHARE_ITERATIONS
from experiment_manager.preparation.configuration import configuration_of
from experiment_manager.protocol import protocol_of


def main() -> None:
    """Measure, and print E, C and lambda."""
    share = float(sys.argv[1])
    request = request_of(arguments([*sys.argv[2:], "--lambda", "0"]))
    configuration = configuration_of(request, "unknown")
    protocol = protocol_of(configuration)
    loop = make_loop(configuration)
    errors, rates_w = [], []
    for episode in protocol.training_episodes():
        if episode.training_iteration >= SHARE_ITERATIONS:
            break
        loop.plant.reconfigure(protocol.plant_settings(episode))
        for step in loop.run_episode(episode):
            if step.answer is not None:
                errors.append(float(step.answer.percept.encoding.reconstruction_error.sum()))
                rates_w.append(step.answer.percept.metabolic_rate_w)
    loop.plant.close()
    error, rate_w = np.mean(errors), np.mean(rates_w)
    weight = share * error / ((1.0 - share) * rate_w)
    print(
        f"{len(errors)} iterations: mean E {error:.4f}, mean C {rate_w:.4f} W; lambda {weight:.6g} "
        f"per W makes lambda C {share:g} of E + lambda C"
    )


if __name__ == "__main__":
    main()
