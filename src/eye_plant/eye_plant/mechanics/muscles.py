"""Positions among the twelve eye muscles, in the order of lockstep.command_space."""

import numpy as np

from lockstep.command_space import MUSCLE_NAMES

N_MUSCLES = len(MUSCLE_NAMES)

# Positions of the horizontal recti among the twelve, left before right.
MEDIAL = np.array([0, 6])
LATERAL = np.array([1, 7])
HORIZONTAL = np.array([0, 1, 6, 7])
