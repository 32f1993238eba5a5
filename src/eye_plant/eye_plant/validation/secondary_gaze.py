"""Innervation of the anatomical eyes for gaze straight up, down, in and out."""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import root

from eye_plant.mechanics.model import MechanicsConfig
from eye_plant.mechanics.oculomotor import Oculomotor
from lockstep.command_space import MUSCLES

Array = NDArray[np.float64]

GAZES_DEG = (-30.0, -15.0, 15.0, 30.0)

# As much as gaze of 20 deg or so takes; none of the tonic levels is lower.
_PROBE = 0.07


def gaze_directions(eyes: Oculomotor) -> Array:
    """Innervation patterns (2, 6) that turn an eye sideways and upward, per deg, without torsion.

    The smallest changes of the six muscles' tonic levels that do so, judged by how the eye turns
    when one muscle's activation rises and falls by 0.07: vertical gaze takes the recti and the
    obliques together. The pattern stays the same for all
    gazes, so the torsion away from the primary position is the plant's own.
    """
    tonic = eyes.tonic_activations[: len(MUSCLES)]
    turns_deg = np.stack(
        [
            (_gaze_deg(eyes, tonic + probe) - _gaze_deg(eyes, tonic - probe)) / (2.0 * _PROBE)
            for probe in _PROBE * np.eye(len(MUSCLES))
        ],
        axis=1,
    )
    return np.array(np.linalg.pinv(turns_deg)[:, :2].T, dtype=np.float64)


def gaze_along(eyes: Oculomotor, directions: Array, wanted_deg: Array) -> Array:
    """Bring an eye to adduction and elevation (2,) along the patterns; return its angles (3,)."""
    tonic = eyes.tonic_activations[: len(MUSCLES)]

    def error_deg(drives: Array) -> Array:
        return _gaze_deg(eyes, tonic + drives @ directions)[:2] - wanted_deg

    # The patterns are per degree, so the wanted angles are a good guess.
    drives = root(error_deg, wanted_deg).x
    return _gaze_deg(eyes, tonic + drives @ directions)


def worst_torsion_deg(config: MechanicsConfig) -> float:
    """Greatest torsion over gaze 15 and 30 deg in, out, up and down."""
    eyes = Oculomotor(config)
    directions = gaze_directions(eyes)
    worst = 0.0
    for gaze_deg in GAZES_DEG:
        for wanted_deg in (np.array([gaze_deg, 0.0]), np.array([0.0, gaze_deg])):
            angles = gaze_along(eyes, directions, wanted_deg)
            worst = max(worst, abs(float(angles[2])))
    return worst


def _gaze_deg(eyes: Oculomotor, activations: Array) -> Array:
    """Angles (3,) of the left eye, settled at the activations (6,) of both eyes' muscles."""
    eyes.settle(np.tile(np.clip(activations, 0.0, 1.0), 2))
    angles: Array = np.degrees(eyes.state().eye_angles_rad[0])
    return angles
