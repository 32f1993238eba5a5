"""How eyes move to a command over time, which their observations do not show."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eye_plant.mechanics.oculomotor import Oculomotor

Array = NDArray[np.float64]

# Of the peak velocity. Saccades of a degree do not come near a velocity for all sizes.
_THRESHOLD_SHARE = 0.1


@dataclass(frozen=True)
class Movement:
    """A line of sight over time, from the onset of a command at 0 s.

    time_s: (n + 1,), evenly spaced; sight: (n + 1, 3) unit vectors.
    """

    time_s: Array
    sight: Array

    @property
    def amplitude_deg(self) -> float:
        """Angle between the first and the last line of sight."""
        return float(angles_deg(self.sight[0], self.sight[-1]))

    @property
    def velocity_deg_s(self) -> Array:
        """Angular velocity (n,) of the line of sight, of each interval."""
        return angles_deg(self.sight[:-1], self.sight[1:]) / np.diff(self.time_s)

    @property
    def peak_velocity_deg_s(self) -> float:
        """Greatest velocity."""
        return float(self.velocity_deg_s.max())

    @property
    def duration_s(self) -> float:
        """Time around the peak for which velocity is at least a tenth of it; 0 without movement."""
        velocity = self.velocity_deg_s
        i_peak = int(velocity.argmax())
        is_slow = velocity < _THRESHOLD_SHARE * velocity[i_peak]
        before, after = is_slow[:i_peak][::-1], is_slow[i_peak:]
        if not velocity[i_peak]:
            return 0.0
        n_before = int(before.argmax()) if before.any() else len(before)
        n_after = int(after.argmax()) if after.any() else len(after)
        return float((n_before + n_after) * (self.time_s[1] - self.time_s[0]))


def angles_deg(first: Array, second: Array) -> Array:
    """Return the angles (...) between vectors (..., 3), also where they are tiny."""
    across = np.linalg.norm(np.cross(first, second), axis=-1)
    angles: Array = np.degrees(np.arctan2(across, (first * second).sum(axis=-1)))
    return angles


def movements(
    eyes: Oculomotor, before: Array, command: Array, duration_s: float, n_intervals: int
) -> tuple[Movement, Movement]:
    """Return how the left and the right line of sight move from rest to a step of activation.

    before, command: activations (12,), held until 0 s and from then on; n_intervals: of equal
    length. The eyes are simulated whatever their moves are, and left where they are after
    duration_s. Raises InputError for activations out of range.
    """
    eyes.settle(before)
    interval_s = duration_s / n_intervals
    sights = [eyes.eye_rotations()[..., 0]]
    for _ in range(n_intervals):
        eyes.advance(command, interval_s)
        sights.append(eyes.eye_rotations()[..., 0])
    time_s: Array = interval_s * np.arange(n_intervals + 1, dtype=np.float64)
    left, right = np.stack(sights, axis=1)
    return Movement(time_s, left), Movement(time_s, right)
