"""Controls: runs that lack something, beside which it shows what that something is worth."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from lockstep import COMMAND_SPACES, PAIR, InputError

# The settings of each control, by key.
CONTROLS: Mapping[str, Mapping[str, Any]] = MappingProxyType(
    {
        # Nothing of pictures or energy in the reward.
        "random_reward": {"sparse_coder.random_reward": True},
        # Training hardly begins anywhere but near one wrong posture.
        "starts_elsewhere": {"experiment_manager.aside_share": 0.9},
        # No inverse of the eyes chose where training begins. Errors scatter by 2.1, 1.4 and 1.8 deg
        # (SD of 200 draws); drawn errors by 1.7, 0.9 and 2.3 deg. Both superior obliques alike
        # rotate the eyes against each other, and leave vertical errors as they are.
        "starts_tonic": {
            "experiment_manager.tonic_start_spread": 0.002,
            "experiment_manager.tonic_common_spread": [0.0, 0.0, 0.0, 0.0, 0.02, 0.0],
        },
        "without_features": {"vergence_rl.state_entries": "activations"},
        "without_activations": {"vergence_rl.state_entries": "features"},
    }
)
_OF_STARTS = ("starts_elsewhere", "starts_tonic")


def check_control(control: str | None, by: str, command_space: str) -> None:
    """Raise InputError for a control that changes nothing; by: how errors name it.

    Where the pair begins does not depend on the object.
    """
    turning = COMMAND_SPACES[command_space].turning
    if control in _OF_STARTS and turning == COMMAND_SPACES[PAIR]:
        others = ", ".join(name for name in CONTROLS if name not in _OF_STARTS)
        raise InputError(
            f"{by}: with command_space {command_space} expected {others}, got {control!r}"
        )
