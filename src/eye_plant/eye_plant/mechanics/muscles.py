"""The twelve eye muscles: their names and order."""

import numpy as np

SIDES = ("left", "right")
MUSCLES = (
    "medial_rectus",
    "lateral_rectus",
    "superior_rectus",
    "inferior_rectus",
    "superior_oblique",
    "inferior_oblique",
)
MUSCLE_NAMES = tuple(f"{side}_{muscle}" for side in SIDES for muscle in MUSCLES)
N_MUSCLES = len(MUSCLE_NAMES)

# Positions of the horizontal recti among the twelve, left before right.
MEDIAL = np.array([0, 6])
LATERAL = np.array([1, 7])
HORIZONTAL = np.array([0, 1, 6, 7])
