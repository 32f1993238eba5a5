"""What all packages share: the protocol between the nodes, settings, muscle names, randomness.

Importing this package imports no ROS; the modules that need rclpy import it themselves.
"""

from lockstep.command_space import (
    ALL_MUSCLES,
    COMMAND_SPACES,
    HORIZONTAL_RECTI,
    INTRAOCULAR_NAMES,
    MUSCLE_NAMES,
    PAIR,
    SIDES,
    CommandSpace,
)
from lockstep.configuration import build, flatten
from lockstep.errors import DivergenceError, InputError
from lockstep.files.state_file import read_state, write_state
from lockstep.randomness import generator
from lockstep.settings import check_settings, setting

__all__ = [
    "ALL_MUSCLES",
    "COMMAND_SPACES",
    "HORIZONTAL_RECTI",
    "INTRAOCULAR_NAMES",
    "MUSCLE_NAMES",
    "PAIR",
    "SIDES",
    "CommandSpace",
    "DivergenceError",
    "InputError",
    "build",
    "check_settings",
    "flatten",
    "generator",
    "read_state",
    "setting",
    "write_state",
]
