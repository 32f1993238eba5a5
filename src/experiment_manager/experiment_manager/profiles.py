"""Named sets of settings: the paper's, and a demonstration of ten minutes."""

from collections.abc import Mapping
from typing import Any

# Settings by node; what is not named keeps the paper's default.
Settings = Mapping[str, Mapping[str, Any]]

PAPER: Settings = {}

DEMONSTRATION: Settings = {
    "vergence_rl": {"hidden_initial_width": 0.09},
    "experiment_manager": {
        "protocol.n_training_iterations": 60_000,
        "protocol.test_iterations": [0, 20_000, 40_000],
        "protocol.n_stimuli_per_test": 8,
    },
}

PROFILES: Mapping[str, Settings] = {"paper": PAPER, "demonstration": DEMONSTRATION}
