"""Frozen learners look at the nine positions and at random places; the least energy beside them."""

import itertools
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.examinations.positions.posture import Posture
from active_binocular_vision.examinations.positions.targets import (
    DISTANCES_M,
    N_RANDOM,
    NINE_POSITIONS_DEG,
    activations_ahead,
    check_looks_at_targets,
    random_targets_deg,
    wanted_angles_deg,
    wanted_gaze_deg,
)
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.shown import OWN_TEST_STIMULI, Shown
from active_binocular_vision.learners.viewing import Viewing
from experiment_manager.experiment.starts import gaze_inverse
from experiment_manager.in_process.loop import InProcessLoop
from experiment_manager.terminal.progress_lines import progress
from eye_plant.mechanics.oculomotor import Oculomotor
from lockstep import InputError

Array = NDArray[np.float64]

_N_PICTURES = 5
# The eye that may be covered: the target is a place in the other one's picture.
_COVERABLE = "right"


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
class Examined:
    """What frozen learners did at the nine positions and at random places.

    stimuli: what was shown, in words, "" for the run's own; covered: side of an eye, "" for none;
    nine: each position with each picture; random: each place with one picture.
    """

    learners: FrozenLearners
    stimuli: str
    n_pictures: int
    n_iterations: int
    covered: str
    nine: Gazes
    random: Gazes


def examine(
    learners: FrozenLearners,
    shown: Shown = OWN_TEST_STIMULI,
    covered: str = "",
    *,
    distances_m: tuple[float, ...] = DISTANCES_M,
    n_random: int = N_RANDOM,
) -> Examined:
    """Let the eyes look; each look is an episode that begins straight ahead.

    covered: the side of an eye that sees black, "" for none. Raises InputError for learners,
    pictures or a covered eye that cannot be used.
    """
    check_looks_at_targets(learners, shown, "--nine-positions")
    if covered not in ("", _COVERABLE):
        raise InputError(
            f"--cover-eye: expected {_COVERABLE}, since the target is a place in the left eye's "
            f"picture, got {covered}"
        )
    stimuli = shown.load(learners.plant.stimuli, _N_PICTURES)
    n_pictures = len(stimuli.all)
    with learners.loop(stimuli) as loop:
        looking = _Looking(learners, loop, covered)
        each = np.tile(np.arange(n_pictures), (len(NINE_POSITIONS_DEG), 1))
        in_turn = np.arange(n_random)[:, None] % n_pictures
        nine = looking.at(NINE_POSITIONS_DEG, distances_m, each)
        random = looking.at(random_targets_deg(n_random), distances_m, in_turn)
    n_iterations = looking.n_iterations
    return Examined(learners, shown.text, n_pictures, n_iterations, covered, nine, random)


class _Looking:
    """Learners' eyes and eyes with the least energy, before the same targets."""

    def __init__(self, learners: FrozenLearners, loop: InProcessLoop, covered: str) -> None:
        manager = learners.manager
        protocol = manager
        self.n_iterations = protocol.iterations_per_trial
        self._n_fixations = self.n_iterations // protocol.fixation_iterations
        self._learners, self._loop = learners, loop
        self._settings = {f"camera.{covered}_occluded": True} if covered else {}
        self._commanded = protocol.space.indices
        self._eyes = Oculomotor(manager.mechanics)
        self._positions_m = self._eyes.eye_positions_m()
        self._inverse = gaze_inverse(protocol, manager.mechanics)

    def at(
        self,
        targets_deg: Array,
        distances_m: tuple[float, ...],
        pictures: NDArray[np.int64],
    ) -> Gazes:
        """Look at all targets (n, 2) from all distances; pictures: (n, n_pictures) for each."""
        gazes = list(itertools.product(distances_m, zip(targets_deg, pictures, strict=True)))
        wanted_deg: list[Array] = []
        eyes: list[Posture] = []
        optimum: list[Posture] = []
        for distance_m, (target_deg, numbers) in progress(
            gazes, file=sys.stderr, desc="nine positions", unit="gaze"
        ):
            wanted_deg.append(wanted_gaze_deg(self._positions_m, target_deg, distance_m))
            eyes += self._looks(target_deg, distance_m, numbers.tolist())
            optimum.append(self._least(target_deg, distance_m, wanted_deg[-1]))
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
        self, target_deg: Array, distance_m: float, pictures: Sequence[int]
    ) -> Iterator[Posture]:
        """Yield where the eyes end before each picture."""
        first = activations_ahead(self._learners, self._positions_m, distance_m)
        for i_picture in pictures:
            viewing = Viewing(self._loop, i_picture, distance_m, first.tolist())
            viewing.look(self.n_iterations, self._settings, target_deg.tolist() * self._n_fixations)
            eyes = self._loop.plant.oculomotor
            yield Posture.of(eyes, self._commanded, target_deg, distance_m)

    def _least(self, target_deg: Array, distance_m: float, wanted_deg: Array) -> Posture:
        """Return the cheapest posture without errors, cycloversion being free."""
        try:
            least = self._inverse.least(wanted_angles_deg(wanted_deg), distance_m)
        except InputError:
            return Posture.unreached()
        self._eyes.settle(least.activations)
        return Posture.of(self._eyes, self._commanded, target_deg, distance_m)
