"""Errors read out linearly from what is seen, calibrated once on training pictures.

Places with known errors are taken from the run's training episodes: each starts as in training, and
then shows errors of all sizes, from the largest with which episodes begin to a hundredth of them.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.baselines.bench import Bench, Seen, errors_deg
from active_binocular_vision.baselines.turning import MotorMap
from lockstep import generator

Array = NDArray[np.float64]
Entries = Callable[[Seen], Array]

# Least shares of the errors at an episode's start, in powers of ten.
_LEAST_POWER = -2.0
# An error e is as important as 1 / (e^2 + this^2): small ones say where the eyes stop.
_EXACT_BELOW_DEG = 0.1
_PENALTY = 1e-3


@dataclass(frozen=True)
class ReadOut:
    """error = (x - mean) / scale . weights + offset; mean, scale, weights: (n,)."""

    mean: Array
    scale: Array
    weights: Array
    offset: float

    def __call__(self, entries: Array) -> Array:
        """Return the errors (...,) that entries (..., n) show."""
        errors: Array = (entries - self.mean) / self.scale @ self.weights + self.offset
        return errors


def ridge(entries: Array, errors: Array, importance: Array, penalty: float) -> ReadOut:
    """Return the least of sum i (e - e(x))^2 + penalty |w|^2 sum i.

    w = (Z^T I Z + penalty sum i)^-1 Z^T I (e - offset)  (Hoerl & Kennard 1970), Z the entries
    (n_places, n) less their mean, in units of their SD, which both weigh places as importance i
    (n_places,) does; entries that do not vary count 0. errors: (n_places,).
    """
    mean = np.average(entries, axis=0, weights=importance)
    offset = float(np.average(errors, weights=importance))
    deviation = np.sqrt(np.average((entries - mean) ** 2, axis=0, weights=importance))
    scale = np.where(deviation > 0.0, deviation, 1.0)
    z = (entries - mean) / scale
    weighted = z * importance[:, None]
    squares = weighted.T @ z + penalty * importance.sum() * np.eye(z.shape[1])
    return ReadOut(mean, scale, np.linalg.solve(squares, weighted.T @ (errors - offset)), offset)


def calibrated_sensor(
    bench: Bench, motor: MotorMap, entries_of: Entries, n_axes: int, n_places: int
) -> Callable[[Seen], Array]:
    """Return the sensor of entries, calibrated at so many places.

    n_axes: of the three errors, the first so many are measured; the others are said to be 0.
    """
    places = islice(known_places(bench, motor), n_places)
    entries, errors = map(
        np.array, zip(*((entries_of(given), error) for given, error in places), strict=True)
    )
    importance = 1.0 / (errors**2 + _EXACT_BELOW_DEG**2)
    read_outs = [
        ridge(entries, errors[:, axis], importance[:, axis], _PENALTY) for axis in range(n_axes)
    ]

    def sensor(seen: Seen) -> Array:
        now = entries_of(seen)
        return np.array([read_out(now) for read_out in read_outs] + [0.0] * (3 - n_axes))

    return sensor


def known_places(bench: Bench, motor: MotorMap) -> Iterator[tuple[Seen, Array]]:
    """Yield what is seen at places of training episodes, and the true errors (3,) there in deg."""
    for episode in bench.protocol.training_episodes():
        draw = generator(bench.manager.seed, "known places", episode.episode)
        start_deg = now_deg = np.zeros(3)

        def elsewhere(seen: Seen, draw: np.random.Generator = draw) -> Array:
            share = draw.choice((-1.0, 1.0), 3) * 10.0 ** draw.uniform(_LEAST_POWER, 0.0, 3)
            return motor.command(seen.activations, now_deg - share * start_deg)  # noqa: B023

        for seen in bench.observations(elsewhere, episode):
            if seen.pictures is not None:
                now_deg = errors_deg(seen)
                start_deg = now_deg if seen.iteration == 0 else start_deg
                yield bench.given(seen), now_deg
