"""Frozen learners look at the nine positions and at random places; the least energy beside them."""

import itertools
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.examinations.nine_positions.posture import Posture
from active_binocular_vision.learners.session import Session
from eye_plant import EyePlantConfig
from eye_plant.mechanics.oculomotor import Oculomotor
from lockstep import InputError, generator
from lockstep.machine.progress_lines import progress

Array = NDArray[np.float64]

# Azimuth (right) and elevation, row by row as a chart shows them.
NINE_POSITIONS_DEG = np.array([(a, e) for e in (8.0, 0.0, -8.0) for a in (-8.0, 0.0, 8.0)])
_LARGEST_RANDOM_DEG = 10.0
# The same places for all runs, so that they compare.
_SEED = 0


@dataclass(frozen=True)
class Gazes:
    """Where eyes were to look, and what they did in the end.

    targets_deg: (n, 2) azimuth and elevation from the left eye; pictures: (n, n_pictures) numbers
    of those that were shown; wanted_gaze_deg: (n_distances, n, 2, 2) of eyes that look there; eyes:
    (n_distances, n, n_pictures) the learners' own; optimum: (n_distances, n) those with the least
    energy.
    """

    targets_deg: Array
    distances_m: tuple[float, ...]
    pictures: NDArray[np.int64]
    wanted_gaze_deg: Array
    eyes: Posture
    optimum: Posture


@dataclass(frozen=True)
class NinePositionsTraces:
    """nine: each position with each picture; random: each place with one picture."""

    plant: EyePlantConfig
    covered: str
    nine: Gazes
    random: Gazes


def random_targets_deg(n_targets: int) -> Array:
    """Draw azimuth and elevation (n, 2), each uniform within 10 deg."""
    draws = (generator(_SEED, "position", i) for i in range(n_targets))
    drawn = [draw.uniform(-_LARGEST_RANDOM_DEG, _LARGEST_RANDOM_DEG, 2) for draw in draws]
    return np.array(drawn).reshape(n_targets, 2)


class Looking:
    """Learners' eyes and eyes with the least energy, before the same targets."""

    def __init__(self, session: Session, covered: str) -> None:
        """session: of learners that make saccades; covered: eye that sees black, or none."""
        learners = session.learners
        self.n_iterations = learners.manager.iterations_per_trial
        self._session, self._covered = session, covered
        self._turns_deg = learners.plant.camera.turns_deg
        self._commanded = learners.manager.space.indices
        self._eyes = Oculomotor(learners.plant.mechanics)
        self._correct = session.correct(0.0)

    def at(
        self, targets_deg: Array, distances_m: tuple[float, ...], pictures: NDArray[np.int64]
    ) -> Gazes:
        """Look at all targets (n, 2) from all distances; pictures: (n, n_pictures) for each."""
        gazes = list(itertools.product(distances_m, zip(targets_deg, pictures, strict=True)))
        wanted_deg: list[Array] = []
        eyes: list[Posture] = []
        optimum: list[Posture] = []
        for distance_m, (target_deg, numbers) in progress(
            gazes, file=sys.stderr, desc="nine positions", unit="gaze"
        ):
            target = target_deg.tolist()
            wanted_deg.append(self._correct.wanted_gaze_deg(distance_m, target))
            eyes += self._looks(target, distance_m, numbers.tolist())
            optimum.append(self._least(target, distance_m))
        shape = len(distances_m), len(targets_deg)
        return Gazes(
            targets_deg,
            distances_m,
            pictures,
            np.reshape(wanted_deg, (*shape, 2, 2)),
            Posture.stacked(eyes, (len(distances_m), *pictures.shape)),
            Posture.stacked(optimum, shape),
        )

    def _looks(
        self, target_deg: Sequence[float], distance_m: float, pictures: Sequence[int]
    ) -> Iterator[Posture]:
        """Yield where the eyes end before each picture; each look begins straight ahead."""
        for i_picture in pictures:
            eyes = self._session.eyes_as_healthy(i_picture, distance_m)
            eyes.look(self.n_iterations, covered=self._covered, target_deg=target_deg)
            yield self._posture(self._session.loop.plant.oculomotor, target_deg, distance_m)

    def _least(self, target_deg: Sequence[float], distance_m: float) -> Posture:
        """Return the cheapest posture without errors, cycloversion being free."""
        try:
            least = self._correct.least(distance_m, target_deg)
        except InputError:
            return Posture.unreached()
        self._eyes.settle(least.activations)
        return self._posture(self._eyes, target_deg, distance_m)

    def _posture(self, eyes: Oculomotor, target_deg: Sequence[float], distance_m: float) -> Posture:
        seen = self._turns_deg, self._commanded, target_deg, distance_m
        return Posture.of(eyes, *seen, leads=int(self._covered == "left"))
