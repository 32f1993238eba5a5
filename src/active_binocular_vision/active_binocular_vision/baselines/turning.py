"""From measured errors to a command, for methods that learn no muscles."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.baselines.bench import Seen
from experiment_manager import ExperimentManagerConfig
from eye_plant import EyePlantConfig, GazeInverse
from eye_plant.inverse.gaze import ERRORS, TURNED_ANGLES
from lockstep import COMMAND_SPACES, HORIZONTAL_RECTI, PAIR

Array = NDArray[np.float64]

# Returns the errors (3,) in deg that are seen, signed as GazeError's; 0 where there is no saying.
Sensor = Callable[[Seen], Array]


class MotorMap:
    """How activations turn the eyes, from the simulator. Our own learners never get it."""

    def __init__(self, manager: ExperimentManagerConfig, plant: EyePlantConfig) -> None:
        """Build an inverse of the eyes of a plant, within the limits of their commands."""
        self._commanded = manager.space
        is_pair = manager.turning_space == PAIR
        # Of the pair both eyes change alike, since their errors are alike and version stays.
        name = HORIZONTAL_RECTI if is_pair else manager.command_space
        self._space, self._angles = COMMAND_SPACES[name], TURNED_ANGLES[name]
        lowest, highest = (
            np.tile(of_commands, 2 if is_pair else 1)
            for of_commands in (manager.limits.lowest, manager.limits.highest)
        )
        self._inverse = GazeInverse(
            plant.mechanics, self._space, lowest, highest, plant.camera.turns_deg
        )

    def command(self, activations: Array, errors_deg: Array) -> Array:
        """Return the activations (n_commands,) that remove errors (3,), and keep the version.

        activations: (12,) of now. Errors about axes that the commands do not turn are ignored.
        """
        removed = dict(zip(ERRORS, -errors_deg, strict=True))
        change_deg = {name: float(removed.get(name, 0.0)) for name in self._angles}
        changed = activations.copy()
        changed[self._space.indices] = self._inverse.turned(
            activations[self._space.indices], change_deg
        )
        return self._commanded.from_all(changed)


def steering(sensor: Sensor, motor: MotorMap) -> Callable[[Seen], Array]:
    """Return the controller that removes at once whatever error a sensor measures."""
    return lambda seen: motor.command(seen.activations, sensor(seen))
