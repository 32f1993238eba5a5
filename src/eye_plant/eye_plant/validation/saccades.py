"""Saccades of the free-running anatomical eyes by pulse-step commands.

The agonist gets a pulse with its antagonist silent, then the antagonist a short braking pulse with
the agonist silent (the rebound burst of its motoneurons, Enderle 2002), then both the step: the
activations that hold the eye where it shall stay. Muscles relax in about 40 ms; without the brake
no saccade of this plant would end in time.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from eye_plant.mechanics.oculomotor import LATERAL, MEDIAL, Oculomotor

Array = NDArray[np.float64]

# A saccade is what lies between its crossings of this velocity.
THRESHOLD_DEG_S = 30.0
# The antagonist of an eye held this far into the agonist's field is silent.
SILENT_ANTAGONIST_DEG = 30.0


@dataclass(frozen=True)
class PulseStep:
    """Height in activation and duration of the agonist's pulse and of the antagonist's brake."""

    pulse: float
    pulse_s: float
    brake: float
    brake_s: float


# Adducting saccades by amplitude in deg, for the anatomical parameter set: pulse heights chosen,
# the rest fitted so that the eye arrives on the main sequence and stays.
PULSES: Mapping[float, PulseStep] = MappingProxyType(
    {
        5.0: PulseStep(0.50, 0.0119, 0.214, 0.0261),
        10.0: PulseStep(0.75, 0.0222, 0.315, 0.0221),
        15.0: PulseStep(0.88, 0.0343, 0.423, 0.0153),
        20.0: PulseStep(1.00, 0.0417, 0.331, 0.0178),
        25.0: PulseStep(1.00, 0.0523, 0.252, 0.0185),
        30.0: PulseStep(1.00, 0.0654, 0.239, 0.0134),
    }
)


@dataclass(frozen=True)
class Saccade:
    """One eye's adduction over time, (n,) each, from the command's onset."""

    time_s: Array
    adduction_deg: Array
    velocity_deg_s: Array

    @property
    def _crossings(self) -> tuple[int, int]:
        above = self.velocity_deg_s > THRESHOLD_DEG_S
        start = int(np.argmax(above))
        return start, start + int(np.argmin(above[start:]))

    @property
    def duration_ms(self) -> float:
        """Time between the crossings of 30 deg/s."""
        start, end = self._crossings
        return float(1e3 * (self.time_s[end] - self.time_s[start]))

    @property
    def peak_velocity_deg_s(self) -> float:
        """Greatest velocity."""
        return float(self.velocity_deg_s.max())

    @property
    def amplitude_deg(self) -> float:
        """How far the eye had gone when it fell below 30 deg/s."""
        return float(self.adduction_deg[self._crossings[1]] - self.adduction_deg[0])


def holding_pair(eyes: Oculomotor, adduction_deg: float) -> tuple[float, float]:
    """Medial and lateral activations that hold an eye at an adduction from -45 to 45 deg.

    Reciprocal: the antagonist falls from its tonic level to silence at 30 deg. Settles eyes.
    """
    agonists, antagonists = (MEDIAL, LATERAL) if adduction_deg >= 0.0 else (LATERAL, MEDIAL)
    activations = eyes.tonic_activations
    activations[antagonists] *= max(0.0, 1.0 - abs(adduction_deg) / SILENT_ANTAGONIST_DEG)

    def error_deg(activation: float) -> float:
        activations[agonists] = activation
        eyes.settle(activations)
        return float(np.degrees(eyes.data.qpos[0])) - adduction_deg

    activations[agonists] = brentq(error_deg, 0.0, 1.0)
    return float(activations[MEDIAL[0]]), float(activations[LATERAL[0]])


def make_saccade(
    eyes: Oculomotor, pair: tuple[float, float], command: PulseStep, duration_s: float = 0.35
) -> Saccade:
    """Both eyes adduct from the tonic position to where the pair of activations holds them.

    eyes: of a time step of 1 ms. A step in which the command changes gets the mean of both.
    """
    step = eyes.activations_from(*pair)
    pulse = eyes.activations_from(command.pulse, 0.0)
    brake = eyes.activations_from(0.0, command.brake)
    eyes.settle(eyes.tonic_activations)
    timestep_s = float(eyes.model.opt.timestep)
    n_steps = round(duration_s / timestep_s)
    time_s: Array = np.array([timestep_s * i for i in range(n_steps)])
    angles, velocities = np.empty_like(time_s), np.empty_like(time_s)
    for i, t in enumerate(time_s):
        angles[i], velocities[i] = eyes.data.qpos[0], eyes.data.qvel[0]
        pulsed = np.clip((command.pulse_s - t) / timestep_s, 0.0, 1.0)
        begun = np.clip((command.pulse_s + command.brake_s - t) / timestep_s, 0.0, 1.0)
        eyes.advance(pulsed * pulse + (begun - pulsed) * brake + (1.0 - begun) * step, timestep_s)
    return Saccade(time_s, np.degrees(angles), np.degrees(velocities))
