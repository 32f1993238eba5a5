"""Named sets of settings: the paper's, and a demonstration of ten minutes."""

from collections.abc import Mapping
from typing import Any

# Settings by node; what is not named keeps the paper's default.
Settings = Mapping[str, Mapping[str, Any]]

PAPER: Settings = {}

# Wider output weights of the actor (the paper's: +-0.01) hand the TD error down to its hidden layer
# from the start, so that vergence comes within the first 10,000 iterations. Wider input weights do
# so too, but leave random responses to the images in the policy.
DEMONSTRATION: Settings = {
    "vergence_rl": {"output_initial_width": 0.07},
    "experiment_manager": {
        "protocol.n_training_iterations": 40_000,
        "protocol.test_iterations": [0, 10_000, 20_000],
        "protocol.n_stimuli_per_test": 8,
    },
}

PROFILES: Mapping[str, Settings] = {"paper": PAPER, "demonstration": DEMONSTRATION}
